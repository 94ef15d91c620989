// SPDX-License-Identifier: MIT
#include "core/artwork/face_pixels.hpp"

#include <algorithm>
#include <tuple>

#include <fmt/format.h>

#include "core/artwork/pixel_frame.hpp"
#include "core/geometry/triangulate.hpp"

namespace popcut {

Result<FaceSurface> face_surface(const Pattern& pattern) {
  const auto places = posed_vertices(pattern, pattern.design_psi_rad);
  std::vector<Vec2> flat;
  flat.reserve(pattern.vertices.size());
  for (const PatternVertex& p : pattern.vertices) flat.emplace_back(pattern.u(p), p.v);
  FaceSurface out;
  std::vector<Triangle> triangles;
  for (std::size_t f = 0; f < pattern.faces(); ++f) {
    triangles.clear();
    if (!triangulate(flat, pattern.face(f), triangles))
      return fail(ErrorKind::OutOfRange, fmt::format("faces/{}", f),
                  "is not a simple polygon with an area; repair the pattern");
    for (const Triangle& triangle : triangles) {
      auto& corners = out.triangles.emplace_back();
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t i = triangle[k];
        corners[k] = {{flat[i][1], flat[i][0]}, vec3(places[i])};
      }
      out.face.push_back(static_cast<std::uint32_t>(f));
    }
  }
  return out;
}

std::vector<std::uint32_t> face_pixels(const FaceSurface& surface, const PixelFrame& frame) {
  std::vector<std::uint32_t> face(frame.pixels(), kNoFace);
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const auto& c = surface.triangles[t];
    each_pixel(frame, {c[0].page, c[1].page, c[2].page},
               [&](std::size_t i, std::size_t j, const std::array<double, 3>&) {
                 face[j * frame.width + i] = surface.face[t];
               });
  }
  return face;
}

namespace {

std::vector<CutLine> lines_on_page(const Pattern& pattern, bool folds) {
  std::vector<std::array<PagePoint, 2>> ends;
  for (const PatternEdge& edge : pattern.edges) {
    const bool is_fold = edge.role == EdgeRole::Mountain || edge.role == EdgeRole::Valley;
    if (is_fold != folds) continue;
    const PatternVertex &a = pattern.vertices[edge.from], &b = pattern.vertices[edge.to];
    PagePoint p{a.v, pattern.u(a)}, q{b.v, pattern.u(b)};
    if (q < p) std::swap(p, q);
    ends.push_back({p, q});
  }
  std::sort(ends.begin(), ends.end());
  ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
  std::vector<CutLine> out;
  out.reserve(ends.size());
  for (const auto& [from, to] : ends) out.push_back({from, to});
  return out;
}

}  // namespace

std::vector<CutLine> cut_lines(const Pattern& pattern) { return lines_on_page(pattern, false); }

std::vector<CutLine> fold_lines_on_page(const Pattern& pattern) {
  return lines_on_page(pattern, true);
}

}  // namespace popcut
