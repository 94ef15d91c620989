// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <string>

#include "daemon/service/repositories/job_repository.hpp"
#include "daemon/service/service_store.hpp"
#include "daemon/store/intent_journal.hpp"

namespace popcut::daemon {

/// Corrects the jobs that the last run left, in one transaction. Cutting and paused jobs become
/// interrupted, and their strokes that may have been sent are in doubt. Armed jobs become ready.
/// Planning jobs become queued. Emits an event `recovered {from, to}` for each. In a fleet this
/// changes only jobs in the cutters of this node, and jobs whose plans this node made.
///
/// The database and the journals of intents beside it show which strokes may have been sent
/// (`verdict_on`). If the database lost an attempt, its journal restores it and interrupts the job
/// (`surfacing_of`). If the two disagree, an event `notice`, the log, the job's attention and the
/// ledger's last status say so.
///
/// @param cuts  whether this popcutd cuts an attempt now; such an attempt is not changed
[[nodiscard]] Answer<void> recover(
    ServiceStore& store, JobRepository& jobs, IntentJournals& intents,
    const std::function<bool(const std::string& attempt)>& cuts = {});

/// Closes the work of a fleet node that does not answer, in one transaction: its attempts end as
/// "lost", with every stroke in doubt that is not certain; its armed jobs become ready; other nodes
/// may make its plans.
///
/// @param epoch  of the run that is over; nothing of a later run is changed
[[nodiscard]] Answer<void> close_lost_node(ServiceStore& store, JobRepository& jobs,
                                           const std::string& node, std::int64_t epoch);

/// How a cut of this node stands to its job. In a fleet another node may have called the cut lost,
/// and a person may have changed the job since.
enum class CutStanding : std::uint8_t {
  Current,     ///< the job is about this cut: record its end
  Superseded,  ///< a person changed the job: the end of the cut must not change it
  Recorded,    ///< its end is recorded already
};
/// Makes the state of the job agree with its cut, in a transaction. If another node called the cut
/// lost and nobody changed the job since, the job is cutting again. Without a fleet there is
/// nothing to do.
///
/// @param held  whether the tool is up, because a person requested a pause
[[nodiscard]] CutStanding reconcile(ServiceStore& store, JobRepository& jobs,
                                    const std::string& attempt, bool held);

}  // namespace popcut::daemon
