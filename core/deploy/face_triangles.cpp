// SPDX-License-Identifier: MIT
#include "core/deploy/face_triangles.hpp"

#include <algorithm>
#include <numeric>

#include <fmt/format.h>

#include "core/deploy/pose_table.hpp"

namespace popcut {
namespace {

/// Appends one face. False when it is no simple polygon.
bool add_face(const Pattern& pattern, std::size_t f, FaceTriangles& out) {
  std::vector<Vec2> points;
  for (const std::uint32_t i : pattern.face(f))
    points.emplace_back(flat_place(pattern, pattern.vertices[i]).head<2>());
  std::vector<std::uint32_t> all(points.size());
  std::iota(all.begin(), all.end(), 0U);
  std::vector<std::uint32_t> corners = turning_corners(points, all);
  if (corners.size() < 3) return false;
  if (twice_area(points, corners) < 0) std::reverse(corners.begin(), corners.end());
  // The corners that are kept are what the triangles count.
  const auto base = static_cast<std::uint32_t>(out.corner.size());
  std::vector<std::uint32_t> number(points.size());
  for (std::size_t k = 0; k < corners.size(); ++k) {
    number[corners[k]] = base + static_cast<std::uint32_t>(k);
    out.corner.emplace_back(points[corners[k]][0], points[corners[k]][1], 0.0);
  }
  std::vector<Triangle> triangles;
  if (!triangulate(points, corners, triangles)) return false;
  for (const auto& [a, b, c] : triangles) out.triangle.push_back({number[a], number[b], number[c]});
  return true;
}

}  // namespace

Result<FaceTriangles> triangulate_faces(const Pattern& pattern) {
  FaceTriangles out;
  out.first_corner.push_back(0);
  out.first_triangle.push_back(0);
  for (std::size_t f = 0; f < pattern.faces(); ++f) {
    if (!add_face(pattern, f, out)) {
      return fail(ErrorKind::OutOfRange, fmt::format("faces/{}", f),
                  "is no simple polygon with an area; faces may not cross themselves");
    }
    out.first_corner.push_back(static_cast<std::uint32_t>(out.corner.size()));
    out.first_triangle.push_back(static_cast<std::uint32_t>(out.triangle.size()));
  }
  return out;
}

}  // namespace popcut
