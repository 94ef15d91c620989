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

/// Whether a function of a place from 0 to `reach` is negative anywhere: at one of `samples` + 1
/// even places, or at a least value between them, where a part of a solid is thinner than that.
/// A few evaluations a sample.
[[nodiscard]] bool dips_below_zero(const std::function<double(double)>& value, double reach,
                                   int samples);

}  // namespace popcut
