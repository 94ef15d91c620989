// SPDX-License-Identifier: MIT
#pragma once

#include <functional>

#include "core/design/target/surface.hpp"
#include "core/fit/triangle_soup.hpp"

namespace popcut {

/// The boundary of a solid in the corner x >= 0, z >= 0 over a stretch, as triangles.
///
/// Marching tetrahedra (Doi and Koide, An Efficient Method of Triangulating Equi-Valued Surfaces,
/// 1991) on a grid of 64 to 128 cells along the longest side, six tetrahedra a cell, each crossing
/// found on the solid itself; counter-clockwise from outside. Corner planes and ends are no
/// boundary. Parts thinner than a cell can be missed, and edges are blunt within one.
///
/// @param value    negative inside; where it is not a number is outside; places in mm (x, v, z)
/// @param stretch  its reach is widened until the solid no longer leaves it
[[nodiscard]] TriangleSoup solid_triangles(const std::function<double(const Vec3&)>& value,
                                           const TargetStretch& stretch);

}  // namespace popcut
