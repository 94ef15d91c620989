// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <string>

#include "core/pattern/pattern.hpp"

namespace popcut::hands {

/// Folds of one length on the strip that a person folds to measure their own time.
struct StripFolds {
  double length_mm{};
  int folds{};
  double from_mm{};  ///< their time is that of folds from this length on
};
/// Ten folds of four lengths, the longest first.
inline constexpr std::array<StripFolds, 4> kStrip{{{30, 2, 20}, {12, 2, 10}, {7, 3, 5}, {3, 3, 0}}};

/// The strip: a flap for each fold, mountain and valley in turn, the longest at the left. It has
/// lines only, and fits on A4 and Letter.
[[nodiscard]] Pattern folding_strip();

/// The table of a person who took so many seconds for all folds of each length, for users' tables.
[[nodiscard]] std::string own_hands_json(const std::array<double, kStrip.size()>& seconds);

}  // namespace popcut::hands
