// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <cstdlib>
#include <span>
#include <string_view>
#include <vector>

#include "core/drawing/linework.hpp"
#include "core/result.hpp"

namespace popcut::fuzzing {

/// What is fuzzed: gives any bytes to a parser and ends the program if it breaks a promise. Seeds
/// lie in tests/fuzz/corpus/NAME.
struct Target {
  std::string_view name;
  void (*run)(std::string_view bytes);
  bool is_slow{false};  ///< unoptimised; the driver of the test run gives it a fifth of the inputs
};

/// All targets, by what they read: each source has a table of its own.
[[nodiscard]] std::span<const Target> cutter_targets();
[[nodiscard]] std::span<const Target> daemon_targets();
[[nodiscard]] std::span<const Target> design_targets();
[[nodiscard]] std::span<const Target> drawing_targets();
[[nodiscard]] std::span<const Target> http_targets();
[[nodiscard]] inline std::vector<Target> all_targets() {
  std::vector<Target> all;
  for (const auto& some :
       {cutter_targets(), daemon_targets(), design_targets(), drawing_targets(), http_targets()})
    all.insert(all.end(), some.begin(), some.end());
  return all;
}

inline void demand(bool holds) {
  if (!holds) std::abort();
}

/// True if `result` has a value. A refusal must say why.
template <typename Value, typename Refusal>
[[nodiscard]] bool accepted(const tl::expected<Value, Refusal>& result) {
  demand(result || !result.error().detail.empty());
  return result.has_value();
}

/// Every line has points of its own, and every point is a place on a page.
inline void demand_sound(const LineWork& work) {
  for (const PagePoint& p : work.points)
    demand(std::abs(p.x) <= kMaxCoordinate && std::abs(p.y) <= kMaxCoordinate);
  for (const DrawnLine& line : work.lines)
    demand(line.count >= 2 && line.first + line.count <= work.points.size());
}

}  // namespace popcut::fuzzing
