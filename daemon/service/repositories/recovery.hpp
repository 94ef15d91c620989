// SPDX-License-Identifier: MIT
#pragma once

#include "daemon/service/repositories/job_repository.hpp"

namespace popcut::daemon {

/// Corrects what the last run left, in one transaction: jobs that were cutting or paused are
/// interrupted and strokes that were sent are in doubt; armed jobs are ready; jobs being planned
/// are queued. Emits an event `recovered {from, to}` for each.
[[nodiscard]] Answer<void> recover(ServiceStore& store, JobRepository& jobs);

}  // namespace popcut::daemon
