// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/geometry/vec.hpp"
#include "core/judge/sheet_motion.hpp"
#include "core/pattern/pattern.hpp"
#include "core/progress.hpp"
#include "core/result.hpp"

namespace popcut::judge {

/// A part of a card that is shown, and where it lies among the others.
struct ShownPart {
  std::string name;
  std::uint32_t first_face{}, faces{};  ///< in the pattern of all parts
  std::size_t folds{}, tabs{};          ///< its own creases; tabs that are glued
  std::array<double, 4> box_mm{};       ///< left, top, width and height on the page (v, u)
  /// A place (x, y) of its own sheet is at `u = shift[0] - y`, `v = shift[1] + x` here.
  std::array<double, 2> shift_mm{};
};

/// A card of several parts, its sheets side by side as in `parts_drawing`, and how they move
/// together.
struct PartsMotion {
  Pattern pattern;  ///< without a card; each rigid panel has its own vertices
  std::vector<ShownPart> parts;
  /// From open to shut, with tabs a little above what they are glued on; x is toward who looks at
  /// the front, v to the right, z up. Both pages slope alike; of a card that opens less than flat,
  /// the page that carries most tabs is level, and x leads away from the other one.
  SolvedPoses motion;
  std::string stopped;  ///< why it does not move all the way; empty: it does
};

/// Moves a card of several parts from its FOLD file alone, as verify does. Few openings are taken
/// of a card of very many corners.
///
/// @retval Malformed, OutOfRange  as `verify::read_joint_model`
/// @retval Infeasible  the joints do not hold all parts, or the card does not open
[[nodiscard]] Result<PartsMotion> parts_motion(std::string_view fold_text,
                                               const Progress& progress = {});

}  // namespace popcut::judge
