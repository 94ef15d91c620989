// SPDX-License-Identifier: MIT
#include "core/deploy/standing_card.hpp"

#include "core/geometry/triangulate.hpp"

namespace popcut {

std::vector<float> standing_triangles(const Pattern& pattern) {
  std::vector<Vec2> flat;
  flat.reserve(pattern.vertices.size());
  for (const PatternVertex& p : pattern.vertices) flat.emplace_back(pattern.u(p), p.v);
  std::vector<Triangle> triangles;
  for (std::size_t f = 0; f < pattern.faces(); ++f) {
    const std::size_t before = triangles.size();
    if (!triangulate(flat, pattern.face(f), triangles)) triangles.resize(before);
  }
  const auto at = posed_vertices(pattern, pattern.design_psi_rad);
  std::vector<float> out;
  out.reserve(9 * triangles.size());
  for (const Triangle& triangle : triangles)
    for (const std::uint32_t corner : triangle)
      for (const double value : at[corner]) out.push_back(static_cast<float>(value));
  return out;
}

}  // namespace popcut
