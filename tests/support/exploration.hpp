// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <fmt/format.h>

namespace popcut::testing {

/// What a search of all states of a model found.
struct Exploration {
  std::size_t states{};             ///< that are different
  std::size_t steps{};              ///< from one to the next
  int depth{};                      ///< all that can be reached by so many steps
  std::size_t recoveries{};         ///< starts after a crash
  bool whole{false};                ///< nothing was left out for want of room
  std::string wrong{};              ///< the first that breaks a promise; empty: none
  std::vector<std::string> path{};  ///< how it was reached
};

/// For people: the counts, and what is wrong, step by step.
[[nodiscard]] inline std::string told(const Exploration& found) {
  std::string text = fmt::format("{} states, {} steps, {} recoveries, depth {}", found.states,
                                 found.steps, found.recoveries, found.depth);
  if (!found.wrong.empty()) text += ": " + found.wrong;
  for (const std::string& step : found.path) text += "\n  " + step;
  return text;
}

}  // namespace popcut::testing
