// SPDX-License-Identifier: MIT
#include "core/judge/boxes_likeness.hpp"

#include <algorithm>
#include <vector>

#include "core/geometry/triangulate.hpp"

namespace popcut::judge {

likeness::PrintedFigures boxes_likeness(const BoxedCard& made,
                                        std::span<const likeness::Rgb> colours, int pixels) {
  const bool turns = made.faces_along_spine();
  const std::vector<float> target = seen_in_front(made.target, turns);
  const PartPoses pose = open_pose(made);
  const Structure& card = made.card;
  std::vector<std::vector<float>> faces;
  std::vector<double> near_mm;
  for (std::size_t p = 0; p < card.parts.size(); ++p) {
    if (made.is_inner(p)) continue;
    const SheetPart& part = card.parts[p];
    for (std::uint32_t f = 0; f < part.faces.size(); ++f) {
      std::vector<Triangle> cut;
      if ((p == 0 && (f == card.pages[0] || f == card.pages[1])) ||
          std::find(part.tabs.begin(), part.tabs.end(), f) != part.tabs.end() ||
          !triangulate(part.vertices, part.faces[f], cut))
        continue;
      const auto at = [&](std::uint32_t v) {
        return Vec3(pose[p][f] * Vec3{part.vertices[v].x(), part.vertices[v].y(), 0.0});
      };
      TriangleSoup face;
      for (const auto& [a, b, c] : cut) face.add(at(a), at(b), at(c));
      faces.push_back(seen_in_front(face, turns));
      near_mm.push_back(made.is_bare(p) ? -1.0 : made.near_mm(p));
    }
  }
  std::vector<likeness::PrintedPanel> panels;
  for (std::size_t k = 0; k < faces.size(); ++k) panels.push_back({faces[k], near_mm[k]});
  likeness::Scene scene;
  scene.views = made.is_of_facets() ? likeness::cone_views() : likeness::page_views();
  scene.pixels = pixels;
  if (made.is_of_facets()) scene.corner = likeness::Corner{};
  if (colours.size() != made.target.size()) colours = {};
  return likeness::PrintedTarget(target, colours, scene).measure_panels(panels);
}

}  // namespace popcut::judge
