// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>

#include "core/design/strips/strips.hpp"
#include "core/warning.hpp"

namespace popcut {

/// What the paper's thickness does when a card is shut.
struct ShutStack {
  int layers{};             ///< most panels on each other anywhere, the card's two among them
  double pile_mm{};         ///< thickness of what lies between wall and ground there
  double from_spine_mm{};   ///< distance of that place from the spine
  double v_mm{};            ///< its place along the spine
  double stays_open_rad{};  ///< opening angle below which the card cannot be pressed
  double smallest_panel_mm{};
};

/// Piles up the panels of each strip as they lie when shut (psi = 0), where the point (x, z) lies
/// x + z from the spine.
///
/// Where n panels of a strip lie on each other, the innermost at a distance s from the spine, wall
/// and ground (two of the n) have (n - 2) t of paper between them, so they stay open by at least
/// the angle (n - 2) t / s; the largest of these is `stays_open_rad`, and the place is its. That is
/// a lower bound: it takes the paper as pressed solid and the folds as sharp. O(panels log panels).
[[nodiscard]] ShutStack shut_stack(const Strips& strips, double thickness_mm);

/// One sentence for the designer where thickness matters, else nothing: the card stays open by
/// more than 5 degrees, or the smallest panel is shorter than 3 t, which no fold flattens.
[[nodiscard]] std::optional<Warning> thickness_warning(const ShutStack& stack, double thickness_mm);

}  // namespace popcut
