// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/design/strips/strips.hpp"
#include "core/pattern/pattern.hpp"
#include "core/warning.hpp"

namespace popcut {

/// What a material and a cutter can do, in mm. Zero or none: not checked.
struct MakeLimits {
  double shortest_fold_mm{};         ///< the shortest fold that is dashed well
  double narrowest_mm{};             ///< of strips, slits and the paper between slits
  std::array<double, 2> sheet_mm{};  ///< the largest sheet, either way round
  std::string sheet_name;            ///< whose it is: "sheet A3"
};

/// What of a pattern is too fine or too large to be made: folds that are too short, strips, slits
/// and necks of paper that are too narrow, a sheet that is too large. One sentence a kind, with the
/// number of places, the worst value and where it lies (u, v on the sheet). O(lines log lines).
[[nodiscard]] std::vector<Warning> make_warnings(const Strips& strips, const Pattern& pattern,
                                                 const MakeLimits& limits);

}  // namespace popcut
