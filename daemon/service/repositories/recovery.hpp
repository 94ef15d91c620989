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

/// In a fleet, what a node that does not answer leaves, in one transaction: its cuts are lost, all
/// of them that is not certain in doubt; its arms have lapsed; its plans are free.
///
[[nodiscard]] Answer<void> close_lost_node(ServiceStore& store, JobRepository& jobs,
                                           const std::string& node, std::int64_t epoch);

/// In a fleet, what is known of a cut of this node that another one called lost, in a transaction.
enum class TakeUp : std::uint8_t {
  Goes,        ///< nobody did anything since: it goes on, and the job is cutting again
  Superseded,  ///< a person decided otherwise meanwhile: its end changes nothing but its record
  Ended,       ///< its end is recorded
};
/// @param held  whether its tool is up, because a person asked for a pause
[[nodiscard]] TakeUp take_up(JobRepository& jobs, const std::string& attempt, bool held);

}  // namespace popcut::daemon
