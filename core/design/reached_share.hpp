// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "core/design/strips/strips.hpp"
#include "core/design/target/curve.hpp"
#include "core/design/target/triangle_mesh.hpp"

namespace popcut {

/// Points of a surface, each standing for the same area.
using AreaPoints = std::vector<std::array<double, 3>>;

/// `count` points of the triangles: the area is cut into `count` equal stretches in the order of
/// the triangles, one point in each, the same in every run (additive recurrence, Roberts 2018).
/// None for a mesh without area.
[[nodiscard]] AreaPoints area_points(const TriangleMesh& mesh, std::size_t count);

/// A strip of a surface along the spine: the curve of its section, by x - z. No points: nothing.
struct ProfileStrip {
  double begin_mm{}, end_mm{};        ///< along the spine
  std::vector<SectionPoint> profile;  ///< a falling polyline from wall to ground
};

/// The strips of an opened structure without their panels in wall and ground, at their places along
/// the target.
///
/// @param s_mm  of each slice's centre line
[[nodiscard]] std::vector<ProfileStrip> profile_strips(const Strips& strips,
                                                       std::span<const double> s_mm);

/// The share of a placed surface's area that is at most `near_mm` from the strips; 0 to 1. Points
/// in wall or ground count neither way, because the card itself makes them.
///
/// @param strips  in order along the spine
[[nodiscard]] double reached_share(const AreaPoints& surface, std::span<const ProfileStrip> strips,
                                   double near_mm);

}  // namespace popcut
