// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <string>

#include "daemon/service/repositories/job_repository.hpp"
#include "daemon/service/service_store.hpp"
#include "daemon/store/intent_journal.hpp"

namespace popcut::daemon {

/// Corrects what the last run left, in one transaction: jobs that were cutting or paused are
/// interrupted and strokes that may have been sent are in doubt; armed jobs are ready; jobs being
/// planned are queued. Emits an event `recovered {from, to}` for each. In a fleet it is about the
/// cutters and plans of this node only.
///
/// What may have been sent follows from the database and from the journals of intents beside it
/// (`verdict_on`). A journal of an attempt that the database lost brings its attempt back and
/// interrupts its job (`surfacing_of`). Where the two disagree, an event `notice`, the log, the
/// job's attention and the ledger's last status say so.
///
/// @param cuts  whether this popcutd cuts that attempt now: it is left alone
[[nodiscard]] Answer<void> recover(
    ServiceStore& store, JobRepository& jobs, IntentJournals& intents,
    const std::function<bool(const std::string& attempt)>& cuts = {});

/// Closes what a node of a fleet leaves that does not answer, in one transaction: its attempts end
/// as "lost", with every stroke in doubt that is not certain; its armed jobs are ready; others may
/// make its plans.
///
/// @param epoch  of the life that is over; nothing of a later one is touched
[[nodiscard]] Answer<void> close_lost_node(ServiceStore& store, JobRepository& jobs,
                                           const std::string& node, std::int64_t epoch);

/// What becomes of a cut of this node that another node of the fleet called lost.
enum class TakeUp : std::uint8_t {
  Goes,        ///< nobody did anything since: it goes on, and the job is cutting again
  Superseded,  ///< a person decided otherwise meanwhile: its end changes nothing but its record
  Ended,       ///< its end is recorded
};
/// Brings the job in step with such a cut, in a transaction. Without a fleet every cut goes on.
///
/// @param held  whether its tool is up, because a person asked for a pause
[[nodiscard]] TakeUp take_up(ServiceStore& store, JobRepository& jobs, const std::string& attempt,
                             bool held);

}  // namespace popcut::daemon
