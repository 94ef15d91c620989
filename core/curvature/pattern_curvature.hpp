// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <iosfwd>
#include <span>
#include <vector>

#include "core/curvature/fold_vertices.hpp"
#include "core/curvature/samples.hpp"

namespace popcut {

/// K and H of one fold vertex in one pose.
struct PosedCurvature {
  double psi_rad{};
  std::int32_t i{}, j{};
  Point3 at{};  ///< (x, v, z), mm
  VertexCurvature curvature;
};

/// How many vertices have all four neighbours.
[[nodiscard]] std::size_t inner_count(std::span<const FoldVertex> vertices);

/// Curvature at every inner fold vertex at `psi_rad`, rings (i+1,j) (i,j+1) (i-1,j) (i,j-1).
[[nodiscard]] std::vector<PosedCurvature> pattern_curvature(std::span<const FoldVertex> vertices,
                                                            double psi_rad);

/// Least, largest and mean values over a pattern, vertices without a finite value left out.
struct CurvatureRange {
  double least{}, largest{}, mean{};
  std::size_t count{};
};
struct PatternSummary {
  CurvatureRange K, K_area, H;
};
[[nodiscard]] PatternSummary summary_of(std::span<const PosedCurvature> values);

/// Writes one row a pose and inner vertex: psi, i, j, x, v, z, K, K_area, H, A (rad and mm), with a
/// heading. A value that is not finite (a star whose triangles vanish) is left empty.
void write_curvature_csv(std::span<const FoldVertex> vertices, const Samples& psi_rad,
                         std::ostream& out);

/// The same as one JSON document, `{"vertices": n, "poses": [{"psi_rad": …, "values": […]}]}`, null
/// for what is not finite.
void write_curvature_json(std::span<const FoldVertex> vertices, const Samples& psi_rad,
                          std::ostream& out);

}  // namespace popcut
