// SPDX-License-Identifier: MIT
#pragma once

#include "daemon/service/repositories/job_repository.hpp"
#include "daemon/store/intent_journal.hpp"

namespace popcut::daemon {

/// Corrects what the last run left, in one transaction: jobs that were cutting or paused are
/// interrupted and strokes that may have been sent are in doubt; armed jobs are ready; jobs being
/// planned are queued. Emits an event `recovered {from, to}` for each.
///
/// What may have been sent follows from the database and from the journals of intents beside it
/// (`verdict_on`). A journal of an attempt that the database lost brings its attempt back and
/// interrupts its job (`surfacing_of`). Where the two disagree, an event `notice`, the log, the
/// job's attention and the ledger's last status say so.
[[nodiscard]] Answer<void> recover(ServiceStore& store, JobRepository& jobs,
                                   IntentJournals& intents);

}  // namespace popcut::daemon
