// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/design/strips/strips.hpp"
#include "core/design/target/curve.hpp"
#include "core/geometry/vec.hpp"
#include "core/model/triangle_mesh.hpp"

namespace popcut {

/// `count` points of a mesh in its own units, each standing for the same area (`area_samples`).
/// None for a mesh without area.
[[nodiscard]] std::vector<Vec3> area_points(const TriangleMesh& mesh, std::size_t count);

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
[[nodiscard]] double reached_share(std::span<const Vec3> surface,
                                   std::span<const ProfileStrip> strips, double near_mm);

}  // namespace popcut
