// SPDX-License-Identifier: MIT
#pragma once

#include "daemon/service/repositories/job_repository.hpp"

namespace popcut::daemon {

/// Tells the truth about what the last run left, in one transaction: what was cutting or paused is
/// interrupted and what was on its way is in doubt; what was armed is ready; what was being planned
/// waits. An event `recovered {from, to}` for each.
[[nodiscard]] Answer<void> recover(ServiceStore& store, JobRepository& jobs);

}  // namespace popcut::daemon
