// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "core/geometry/triangulate.hpp"
#include "core/geometry/vec.hpp"
#include "core/result.hpp"

namespace popcut {

/// A closed line; the last point is joined to the first.
using Ring = std::vector<Vec2>;

/// A flat shape in one piece: an outline, counter-clockwise, and the holes in it, clockwise.
struct Area {
  Ring outline;
  std::vector<Ring> holes;
  std::vector<Triangle> triangles;  ///< of its points: the outline's, then those of each hole
};

/// What counts as inside where rings lie over each other (SVG 2, 13.4.2).
enum class FillRule { NonZero, EvenOdd };

inline constexpr std::size_t kMostRingPoints = 200'000;

/// The pieces that closed lines bound, which may cross themselves and each other. Points are kept
/// to a millionth of the whole size. O(n log n) for lines that cross O(n) times.
///
/// @retval OutOfRange  more than `kMostRingPoints`, or a coordinate that is not a finite number
/// @retval Infeasible  they bound no area, or cross so closely that what they bound stays unclear
[[nodiscard]] Result<std::vector<Area>> areas_within(const std::vector<Ring>& rings, FillRule fill);

/// Shapes in the order in which they are painted: what lies within an odd number of a coat's rings
/// is added to what the coats before it left, or taken away from it.
struct Coat {
  std::vector<Ring> rings;
  bool takes_away{false};
};

inline constexpr std::size_t kMostCoats = 200;

/// The pieces that are left in the end. Time is that of `areas_within` for each coat but the first.
///
/// @retval OutOfRange, Infeasible  as `areas_within`; also more than `kMostCoats`
[[nodiscard]] Result<std::vector<Area>> areas_painted(std::vector<Coat> coats);

}  // namespace popcut
