// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <vector>

#include "core/fit/triangle_soup.hpp"

namespace popcut {

/// How densely surfaces are sampled: so many points a mm^2, but never fewer than `least` nor more
/// than `most` on a surface, so that the time of a fit is bounded.
struct SampleDensity {
  double per_mm2{0.25};
  std::size_t least{4096};
  std::size_t most{16384};
};

/// Sum of the triangles' areas, mm^2.
[[nodiscard]] double area_of(const TriangleSoup& soup);

/// How many points a surface of this area gets.
[[nodiscard]] std::size_t samples_of(double area_mm2, const SampleDensity& density);

/// `count` points of the triangles, each standing for the same area: the area is cut into `count`
/// equal stretches in the order of the triangles, one point in each. Points within stretches and
/// triangles come from additive recurrences (Roberts, The Unreasonable Effectiveness of
/// Quasirandom Sequences, 2018), so that they repeat no pattern of the panels and are the same in
/// every run. Triangles without area get none; none at all: no points.
[[nodiscard]] std::vector<Vec3> area_samples(const TriangleSoup& soup, std::size_t count);

}  // namespace popcut
