// SPDX-License-Identifier: MIT
// Part of daemon/service/live/cut_dispatcher.hpp: complete requests that are possible now. None of
// them would be refused for a reason that is known now.
#include <algorithm>

#include "daemon/service/live/cut_dispatcher.hpp"

namespace popcut::daemon {
namespace {

NextAction resume_action(const ResumeRequest& one) {
  return next_action(JobAction::ResumeFrom,
                     {.from_path = one.from_path,
                      .registration = one.re_registered ? "re-registered" : "kept",
                      .accept_double_cut = one.accept_double_cut,
                      .skip_in_doubt = one.skip_in_doubt});
}

}  // namespace

NextAction CutDispatcher::arm_action(const JobRow& row, const std::string& device) {
  return next_action(JobAction::Arm, {.sheet = row.sheet,
                                      .blank = row.blank,
                                      .device = device,
                                      .accept_warnings = row.unaccepted});
}

std::optional<ResumeState> CutDispatcher::resume_state(const JobRow& row) {
  AttemptTable& attempts = parts_.jobs.attempts();
  std::vector<std::vector<FateRun>> fates;
  std::optional<AttemptRow> last;
  for (const AttemptRow& attempt : attempts.of_sheet(row.id, row.sheet)) {
    if (attempt.blank != row.blank) continue;
    fates.push_back(attempts.fates(attempt.id));
    last = attempt;
  }
  if (!last) return std::nullopt;
  return ResumeState{.last = *last,
                     .runs = merged_fates(last->strokes, fates),
                     .facts = {.strokes = last->strokes,
                               .same_device_session = last->end_kind != "media_out" &&
                                                      last->device_session ==
                                                          parts_.devices.session_of(last->device)}};
}

const Armed* CutDispatcher::valid_arm(const std::string& job) {
  const auto stored = parts_.jobs.attempts().armed(job);
  const auto found = next_.find(job);
  if (!stored || stored->invocation != parts_.store.invocation() || found == next_.end())
    return nullptr;
  const auto* const armed = std::get_if<Armed>(&found->second);
  return armed != nullptr && armed->until_ms > parts_.store.monotonic() ? armed : nullptr;
}

// Requests to arm the sheet. If none is possible, requests that make a device ready for it.
std::vector<NextAction> CutDispatcher::arm_actions(const JobRow& row, const ActionRequest* wanted) {
  const auto plan = parts_.plans.table().find(row.plan);
  if (!plan || plan->state != PlanState::Planned || !parts_.jobs.current_sheet(row) ||
      !parts_.intents.why_blocked(row.id).empty())
    return {next_action(JobAction::Cancel)};
  const DeviceRegistry& devices = parts_.devices;
  std::vector<NextAction> others, as_wanted;
  std::vector<std::string> free, busy;
  for (const DeviceRecord& device : devices.list()) {
    const bool usable = devices.usable(device.id).has_value();
    const bool is_wanted = wanted != nullptr && wanted->device == device.id;
    if (!devices.misfit(device.id, *plan, "").empty()) {
      if (auto action =
              usable ? parts_.jobs.plan_again_action(row, device.id, *plan) : std::nullopt)
        (is_wanted ? as_wanted : others).push_back(std::move(*action));
      continue;
    }
    const bool taken = parts_.jobs.table().on_device(device.id).has_value();
    const bool is_for_other = !row.requested_device.empty() && row.requested_device != device.id;
    if (is_for_other || !devices.wrong_site(device.id, row.site).empty()) {
      if (!usable || taken || (row.segment > 1 && is_for_other)) continue;
      (is_wanted ? as_wanted : others).push_back(parts_.jobs.change_action(row, device.id));
    } else if (usable) {
      (taken ? busy : free).push_back(device.id);
    } else {
      for (NextAction& remedy : devices.remedies(device.id)) others.push_back(std::move(remedy));
    }
  }
  std::vector<NextAction> all = as_wanted;
  const bool is_known = free.size() + busy.size() == 1 || !row.requested_device.empty();
  for (const std::string& id : free) all.push_back(arm_action(row, is_known ? "" : id));
  if (!all.empty()) return all;
  // The job that holds a busy device is armed, cutting or paused. If it is cutting, nothing can be
  // requested: wait until it ends.
  for (const std::string& id : busy)
    if (const auto holder = parts_.jobs.table().on_device(id);
        holder && holder->state != JobState::Cutting) {
      const std::vector<NextAction> theirs = parts_.jobs.next_actions_of(*holder);
      all.insert(all.end(), theirs.begin(), theirs.end());
    }
  all.insert(all.end(), others.begin(), others.end());
  return all;
}

// START; if it would be refused, requests that make it possible.
std::vector<NextAction> CutDispatcher::actions_when_armed(const JobRow& row) {
  const NextAction disarm = next_action(JobAction::Disarm);
  const auto plan = parts_.plans.table().find(row.plan);
  const bool may = valid_arm(row.id) != nullptr && plan && parts_.devices.usable(row.device) &&
                   parts_.devices.misfit(row.device, *plan, row.site).empty() &&
                   knows_place(row, row.device);
  if (may && !row.held) return {next_action(JobAction::Start, {.sheet = row.sheet}), disarm};
  std::vector<NextAction> all = parts_.devices.remedies(row.device);
  all.push_back(disarm);
  return all;
}

std::vector<NextAction> CutDispatcher::next_actions(const JobRow& stored,
                                                    const ActionRequest* wanted) {
  std::vector<NextAction> all;
  JobRow row = stored;
  if (const auto changed = parts_.jobs.changed_since_planned(row); !changed.empty()) {
    for (const Warning& one : changed) row.unaccepted.push_back(one.code);
    if (parts_.jobs.may_plan_again(row))
      all.push_back(parts_.jobs.change_action(row, row.requested_device, true));
  }
  const ActionRequest sheet{.sheet = row.sheet};
  const std::vector<JobAction> allowed = allowed_actions(JobRepository::facts_of(row));
  const auto may = [&](JobAction action) {
    return std::find(allowed.begin(), allowed.end(), action) != allowed.end();
  };
  const auto add = [&](JobAction action, const ActionRequest& body = {}) {
    if (may(action)) all.push_back(next_action(action, body));
  };
  if (row.held && !is_terminal(row.state)) all.push_back({"release", QueueRequest{row.id}});
  const auto append = [&](const std::vector<NextAction>& more) {
    all.insert(all.end(), more.begin(), more.end());
  };
  if (row.state == JobState::Armed) append(actions_when_armed(row));
  if (may(JobAction::Resume)) {
    const std::vector<NextAction> remedies = parts_.devices.remedies(row.device);
    const auto device = parts_.devices.find(row.device);
    if (device && !device->enabled)
      append(remedies);
    else
      add(JobAction::Resume);
  }
  if (row.state == JobState::Cutting) add(JobAction::Pause);
  if (row.state == JobState::Ready && may(JobAction::Arm) && knows_place(row, row.requested_device))
    append(arm_actions(row, wanted));
  const bool interrupted = row.state == JobState::Interrupted;
  if (interrupted) append(parts_.devices.remedies(row.device));
  const std::optional<ResumeState> state =
      may(JobAction::ResumeFrom) ? resume_state(row) : std::nullopt;
  if (state) {
    ResumeRequest request{.from_path = row.state == JobState::Ready ? row.first_stroke : -1};
    if (wanted != nullptr && wanted->from_path) request.from_path = *wanted->from_path;
    if (wanted != nullptr) request.re_registered = wanted->registration == "re-registered";
    for (const ResumeRequest& one : possible_resumes(state->runs, request, state->facts))
      all.push_back(resume_action(one));
  }
  if (interrupted || row.segment > 1) add(JobAction::RetrySheet, sheet);
  const bool whole =
      state && std::none_of(state->runs.begin(), state->runs.end(),
                            [](const FateRun& run) { return run.fate == PathFate::NotSent; });
  if (whole) add(JobAction::ConfirmResult, {.sheet = row.sheet, .good = true});
  if (interrupted) add(JobAction::SkipSheet, sheet);
  return all;
}

}  // namespace popcut::daemon
