// SPDX-License-Identifier: MIT
#include "daemon/model/model.hpp"

#include <cstddef>
#include <utility>

#include "daemon/model/json_leaves.hpp"

namespace popcut::daemon {
namespace {

// In the order of the enumerations.
constexpr std::array<std::string_view, 4> kRoles{"viewer", "submitter", "operator", "admin"};
constexpr std::array<std::string_view, 10> kStates{"queued",  "planning", "ready",       "armed",
                                                   "cutting", "paused",   "interrupted", "done",
                                                   "failed",  "cancelled"};
constexpr std::array<std::string_view, 10> kActions{
    "arm",    "disarm",         "start",       "pause",      "resume",
    "cancel", "confirm-result", "retry-sheet", "skip-sheet", "resume-from"};

constexpr std::array<std::string_view, 3> kPlanStates{"pending", "planned", "failed"};

template <typename Value, std::size_t N>
std::optional<Value> find(const std::array<std::string_view, N>& names, std::string_view name) {
  for (std::size_t i = 0; i < N; ++i)
    if (names[i] == name) return static_cast<Value>(i);
  return std::nullopt;
}

}  // namespace

std::string_view name_of(Role role) { return kRoles.at(static_cast<std::size_t>(role)); }
std::string_view name_of(JobState state) { return kStates.at(static_cast<std::size_t>(state)); }
std::string_view name_of(JobAction action) { return kActions.at(static_cast<std::size_t>(action)); }

std::string_view name_of(PlanState state) {
  return kPlanStates.at(static_cast<std::size_t>(state));
}

std::optional<Role> role_from(std::string_view name) { return find<Role>(kRoles, name); }
std::optional<JobState> job_state_from(std::string_view name) {
  return find<JobState>(kStates, name);
}
std::optional<JobAction> job_action_from(std::string_view name) {
  return find<JobAction>(kActions, name);
}
std::optional<PlanState> plan_state_from(std::string_view name) {
  return find<PlanState>(kPlanStates, name);
}

std::string text_in(const Event& event, std::string_view name) {
  std::string text;
  const bool whole = each_json_leaf(event.data, [&](const JsonLeaf& leaf) {
    if (leaf.depth == 1 && leaf.name == name && leaf.text) text = *leaf.text;
  });
  return whole ? text : std::string();
}

NextAction next_action(JobAction action, ActionRequest body, std::string job) {
  return {std::string(name_of(action)), std::move(body), {}, std::move(job)};
}

bool is_terminal(JobState state) {
  return state == JobState::Done || state == JobState::Failed || state == JobState::Cancelled;
}

}  // namespace popcut::daemon
