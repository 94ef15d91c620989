// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "daemon/model/model.hpp"

namespace popcut::daemon {

/// What happens to a job without a person asking for it. None of these leads to `armed`, and only
/// `CutFoundAgain` to `cutting`: of a cut that a person started, and that never ended (rules R1 and
/// R2).
enum class JobEvent : std::uint8_t {
  PlanBegins,      ///< a worker has its design
  PlanComes,       ///< the plan is stored
  PlanFails,       ///< there is none
  ArmLapses,       ///< ten minutes went by, or the device went away
  CutRefused,      ///< the cutter took no byte of the sheet
  CutHeld,         ///< the tool is up at the end of a stroke, as `pause` asked
  CutCompletes,    ///< all strokes certain, and the device said that it rests
  CutUnconfirmed,  ///< all was sent to a device that never answers
  CutBreaks,       ///< ended early: unplugged, stalled, stopped
  CutStops,        ///< ended early because `cancel` asked for it
  Restarts,        ///< popcutd starts again
  IntentsSurface,  ///< a journal knows of strokes that were sent, and the store does not
  PlansAgain,      ///< a person wants another plan; nothing of the job was cut
  CutFoundAgain,   ///< in a fleet: its node was thought lost, and the cut went on all the time
};

/// All of them, for tables.
[[nodiscard]] const std::vector<JobState>& all_states();
[[nodiscard]] const std::vector<JobAction>& all_actions();
[[nodiscard]] const std::vector<JobEvent>& all_events();

/// What an action or event does to a job in a state.
enum class Step : std::uint8_t {
  Refused,  ///< not allowed in this state: 409 for an action; a late event is dropped
  Stays,    ///< allowed; the state stays, the request is noted or changes nothing
  ToQueued,
  ToPlanning,
  ToReady,
  ToArmed,
  ToCutting,
  ToPaused,
  ToInterrupted,
  NextSheet,  ///< the sheet is finished: ready for the next one, or done after the last
  ToFailed,
  ToCancelled,
};

/// The state machine: the whole of it. Everything else only says when a step is not taken.
///
/// Into `cutting` leads `start` from `armed`, and `resume` from `paused`. Into `armed` leads `arm`
/// from `ready`. Ended states refuse everything.
[[nodiscard]] Step step_of(JobState state, JobAction action);
[[nodiscard]] Step step_of(JobState state, JobEvent event);

/// Where a step leads from `state` when `sheet` of `sheets` is the current one.
[[nodiscard]] JobState state_after(JobState state, Step step, int sheet, int sheets);

/// What the rules look at besides the state.
struct JobFacts {
  JobState state{};
  bool held{false};
  bool pausing{false};        ///< `pause` was asked for, the stroke goes on
  bool cancelling{false};     ///< `cancel` was asked for, the stroke goes on
  bool awaits_result{false};  ///< interrupted only because a person must judge the result
  bool begun{false};          ///< ready to continue a sheet that is cut in part
};

/// Whether `action` is allowed, given the facts.
[[nodiscard]] Step step_of(const JobFacts& facts, JobAction action);
/// The allowed actions, in the order of the enumeration.
[[nodiscard]] std::vector<JobAction> allowed_actions(const JobFacts& facts);

/// The least role for an action on one's own job, or on anyone's.
[[nodiscard]] Role role_for(JobAction action, bool own_job);

}  // namespace popcut::daemon
