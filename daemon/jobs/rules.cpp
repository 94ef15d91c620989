// SPDX-License-Identifier: MIT
#include "daemon/jobs/rules.hpp"

namespace popcut::daemon {

const std::vector<JobState>& all_states() {
  using enum JobState;
  static const std::vector<JobState> all{Queued, Planning,    Ready, Armed,  Cutting,
                                         Paused, Interrupted, Done,  Failed, Cancelled};
  return all;
}

const std::vector<JobAction>& all_actions() {
  using enum JobAction;
  static const std::vector<JobAction> all{Arm,    Disarm,        Start,      Pause,     Resume,
                                          Cancel, ConfirmResult, RetrySheet, SkipSheet, ResumeFrom};
  return all;
}

const std::vector<JobEvent>& all_events() {
  using enum JobEvent;
  static const std::vector<JobEvent> all{
      PlanBegins,     PlanComes, PlanFails, ArmLapses, CutRefused,     CutHeld,    CutCompletes,
      CutUnconfirmed, CutBreaks, CutStops,  Restarts,  IntentsSurface, PlansAgain, CutFoundAgain};
  return all;
}

Step step_of(JobState state, JobAction action) {
  using enum JobAction;
  if (is_terminal(state)) return Step::Refused;
  // Of a job whose knife may be down, `cancel` waits for the end of the stroke.
  const bool knife = state == JobState::Cutting || state == JobState::Paused;
  switch (action) {
    case Arm:
      return state == JobState::Ready ? Step::ToArmed : Step::Refused;
    case Disarm:
      return state == JobState::Armed ? Step::ToReady : Step::Refused;
    case Start:
      return state == JobState::Armed ? Step::ToCutting : Step::Refused;
    case Pause:
      return knife ? Step::Stays : Step::Refused;
    case Resume:
      if (state == JobState::Paused) return Step::ToCutting;
      return state == JobState::Cutting ? Step::Stays : Step::Refused;
    case Cancel:
      return knife ? Step::Stays : Step::ToCancelled;
    case ConfirmResult:
      return state == JobState::Interrupted ? Step::NextSheet : Step::Refused;
    case RetrySheet:
      if (state == JobState::Ready) return Step::Stays;
      return state == JobState::Interrupted ? Step::ToReady : Step::Refused;
    case SkipSheet:
      return state == JobState::Ready || state == JobState::Interrupted ? Step::NextSheet
                                                                        : Step::Refused;
    case ResumeFrom:
      if (state == JobState::Ready) return Step::Stays;
      return state == JobState::Interrupted ? Step::ToReady : Step::Refused;
  }
  return Step::Refused;
}

Step step_of(JobState state, JobEvent event) {
  using enum JobEvent;
  const bool knife = state == JobState::Cutting || state == JobState::Paused;
  const auto only = [&](bool allowed, Step step) { return allowed ? step : Step::Refused; };
  switch (event) {
    case PlanBegins:
      return only(state == JobState::Queued, Step::ToPlanning);
    case PlanComes:
      return only(state == JobState::Queued || state == JobState::Planning, Step::ToReady);
    case PlanFails:
      return only(state == JobState::Queued || state == JobState::Planning, Step::ToFailed);
    case ArmLapses:
      return only(state == JobState::Armed, Step::ToReady);
    case CutRefused:
      return only(knife, Step::ToReady);
    case CutHeld:
      return only(state == JobState::Cutting, Step::ToPaused);
    case CutCompletes:
      return only(knife, Step::NextSheet);
    case CutUnconfirmed:
    case CutBreaks:
      return only(knife, Step::ToInterrupted);
    case CutStops:
      return only(knife, Step::ToCancelled);
    case Restarts:
      if (knife) return Step::ToInterrupted;
      if (state == JobState::Armed) return Step::ToReady;
      return only(state == JobState::Planning, Step::ToQueued);
    case IntentsSurface:
      return only(knife || state == JobState::Ready || state == JobState::Armed ||
                      state == JobState::Interrupted,
                  Step::ToInterrupted);
    case PlansAgain:
      return only(
          state == JobState::Queued || state == JobState::Planning || state == JobState::Ready,
          Step::ToQueued);
    case CutFoundAgain:
      return only(state == JobState::Interrupted, Step::ToCutting);
  }
  return Step::Refused;
}

JobState state_after(JobState state, Step step, int sheet, int sheets) {
  switch (step) {
    case Step::Refused:
    case Step::Stays:
      return state;
    case Step::ToQueued:
      return JobState::Queued;
    case Step::ToPlanning:
      return JobState::Planning;
    case Step::ToReady:
      return JobState::Ready;
    case Step::ToArmed:
      return JobState::Armed;
    case Step::ToCutting:
      return JobState::Cutting;
    case Step::ToPaused:
      return JobState::Paused;
    case Step::ToInterrupted:
      return JobState::Interrupted;
    case Step::NextSheet:
      return sheet < sheets ? JobState::Ready : JobState::Done;
    case Step::ToFailed:
      return JobState::Failed;
    case Step::ToCancelled:
      return JobState::Cancelled;
  }
  return state;
}

Step step_of(const JobFacts& facts, JobAction action) {
  const Step step = step_of(facts.state, action);
  switch (action) {
    case JobAction::Arm:
      return facts.held ? Step::Refused : step;
    case JobAction::Start:
      return facts.held ? Step::Refused : step;
    case JobAction::Pause:
      return facts.cancelling ? Step::Refused : step;
    case JobAction::Resume:
      // While it cuts there is something to resume only if a pause is on its way.
      if (facts.cancelling) return Step::Refused;
      return facts.state == JobState::Cutting && !facts.pausing ? Step::Refused : step;
    case JobAction::ResumeFrom:
      // Of a sheet that nothing was cut of there is nothing to resume.
      return facts.state == JobState::Ready && !facts.begun ? Step::Refused : step;
    default:
      return step;
  }
}

std::vector<JobAction> allowed_actions(const JobFacts& facts) {
  std::vector<JobAction> allowed;
  for (const JobAction action : all_actions())
    if (step_of(facts, action) != Step::Refused) allowed.push_back(action);
  return allowed;
}

Role role_for(JobAction action, bool own_job) {
  return action == JobAction::Cancel && own_job ? Role::Submitter : Role::Operator;
}

}  // namespace popcut::daemon
