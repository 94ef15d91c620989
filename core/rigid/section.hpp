// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/geometry/buckets.hpp"

namespace popcut::rigid {

/// Panels parallel to wall or ground, seen along the spine, to which all their folds are parallel.
/// Only panels of different directions meet in folds, at x = offset of the upright one and
/// z = offset of the level one.
struct Section {
  std::vector<std::uint8_t> upright;  ///< one a panel: 1 parallel to the wall, 0 to the ground
  std::vector<double> offset;         ///< one a panel: its x if it is upright, else its z
  Buckets<std::uint32_t> folds;       ///< the panels that each panel meets in a fold

  [[nodiscard]] std::size_t panels() const { return upright.size(); }
};

}  // namespace popcut::rigid
