// SPDX-License-Identifier: MIT
#include "core/judge/layers_likeness.hpp"

#include <algorithm>
#include <limits>
#include <vector>

#include "core/geometry/angle.hpp"
#include "core/geometry/triangulate.hpp"

namespace popcut::judge {

likeness::PrintedFigures layers_likeness(const LayeredCard& made,
                                         std::span<const likeness::Rgb> colours, int pixels) {
  // x toward a person before the front, from the front of the target; y to that person's right.
  const double along = made.looks_along_spine ? 1.0 : -1.0;
  const auto add = [&](const Vec3& p, std::vector<float>& to) {
    for (const double at : {along * (made.begin_mm - p.y()), along * p.x(), p.z()})
      to.push_back(static_cast<float>(at));
  };
  std::vector<float> target;
  for (std::size_t t = 0; t < made.target.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) add(made.target.corner(t, k), target);
  const PartPoses pose = open_pose(made);
  std::vector<std::vector<float>> faces(made.layers.size());
  std::vector<likeness::PrintedLayer> layers;
  constexpr double kFar = std::numeric_limits<double>::infinity();
  const auto between = [&](std::size_t j) {
    return -0.5 * (made.layers[j].depth_mm + made.layers[j + 1].depth_mm);
  };
  for (std::size_t j = 0; j < made.layers.size(); ++j) {
    const SheetPart& part = made.card.parts[j + 1];
    for (std::uint32_t f = 0; f < part.faces.size(); ++f) {
      std::vector<Triangle> cut;
      if (std::find(part.tabs.begin(), part.tabs.end(), f) != part.tabs.end() ||
          !triangulate(part.vertices, part.faces[f], cut))
        continue;
      for (const Triangle& t : cut)
        for (const std::uint32_t v : t)
          add(pose[j + 1][f] * Vec3{part.vertices[v].x(), part.vertices[v].y(), 0.0}, faces[j]);
    }
    layers.push_back({faces[j], j + 1 == made.layers.size() ? -kFar : between(j),
                      j == 0 ? kFar : between(j - 1), made.look.fall, made.look.bend,
                      made.look.raised_share(j) * made.look.bend});
  }
  likeness::Scene scene;
  scene.views = made.opens_flat ? likeness::page_views() : likeness::cone_views();
  scene.pixels = pixels;
  if (colours.size() != made.target.size()) colours = {};
  return likeness::PrintedTarget(target, colours, scene).measure_layers(layers);
}

}  // namespace popcut::judge
