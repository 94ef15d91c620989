// SPDX-License-Identifier: MIT
#include "core/judge/boxes_likeness.hpp"

#include <vector>

namespace popcut::judge {

likeness::PrintedFigures boxes_likeness(const BoxedCard& made,
                                        std::span<const likeness::Rgb> colours, int pixels) {
  const bool turns = made.faces_along_spine();
  const std::vector<float> target = seen_in_front(made.target, turns);
  std::vector<std::vector<float>> faces;
  std::vector<double> near_mm;
  for (const OpenPanel& panel : open_panels(made)) {
    faces.push_back(seen_in_front(panel.triangles, turns));
    near_mm.push_back(made.is_bare(panel.part) ? -1.0 : made.near_mm(panel.part));
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
