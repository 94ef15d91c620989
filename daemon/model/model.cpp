// SPDX-License-Identifier: MIT
#include "daemon/model/model.hpp"

#include <cstddef>

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

std::optional<Role> role_from(std::string_view name) { return find<Role>(kRoles, name); }
std::optional<JobState> job_state_from(std::string_view name) {
  return find<JobState>(kStates, name);
}
std::optional<JobAction> job_action_from(std::string_view name) {
  return find<JobAction>(kActions, name);
}

bool is_terminal(JobState state) {
  return state == JobState::Done || state == JobState::Failed || state == JobState::Cancelled;
}

}  // namespace popcut::daemon
