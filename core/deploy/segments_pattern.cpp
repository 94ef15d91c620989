// SPDX-License-Identifier: MIT
#include "core/deploy/segments_pattern.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

namespace popcut {
namespace {

/// An end of a panel's line, with the strip it is in. Ends meet when they are equal to the digit,
/// as they are in files that are written from one number.
using End = std::tuple<double, double, double, double>;  // v, width, x, z

bool is_level(const SegmentPanel& panel) {
  return std::abs(panel.x1 - panel.x0) > std::abs(panel.z1 - panel.z0);
}

}  // namespace

Pattern pattern_from_segments(const std::vector<SegmentPanel>& panels, std::string name) {
  Pattern pattern;
  pattern.name = std::move(name);
  pattern.card = false;
  pattern.face_first.push_back(0);
  std::map<End, std::uint32_t> first_at;
  for (std::uint32_t f = 0; f < panels.size(); ++f) {
    const SegmentPanel& panel = panels[f];
    const double v0 = panel.v - panel.width / 4, v1 = panel.v + panel.width / 4;
    const std::uint32_t n = 4 * f;
    pattern.vertices.insert(pattern.vertices.end(), {{panel.x0, panel.z0, v0},
                                                     {panel.x1, panel.z1, v0},
                                                     {panel.x1, panel.z1, v1},
                                                     {panel.x0, panel.z0, v1}});
    pattern.face_vertices.insert(pattern.face_vertices.end(), {n, n + 1, n + 2, n + 3});
    pattern.face_first.push_back(n + 4);
    pattern.width_mm = std::max(pattern.width_mm, v1);
    const auto face = static_cast<std::int32_t>(f);
    for (const std::uint32_t side : {0U, 2U})
      pattern.edges.push_back({n + side, n + side + 1, face, -1, EdgeRole::Slit});
    for (const bool far : {false, true}) {
      const End end{panel.v, panel.width, far ? panel.x1 : panel.x0, far ? panel.z1 : panel.z0};
      const auto [met, fresh] = first_at.try_emplace(end, f);
      if (fresh) continue;
      const SegmentPanel& other = panels[met->second];
      const bool mountain =
          far ? is_level(panel) && !is_level(other) : is_level(other) && !is_level(panel);
      pattern.edges.push_back({far ? n + 1 : n, far ? n + 2 : n + 3, face,
                               static_cast<std::int32_t>(met->second),
                               mountain ? EdgeRole::Mountain : EdgeRole::Valley});
    }
  }
  return pattern;
}

}  // namespace popcut
