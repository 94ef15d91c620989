// SPDX-License-Identifier: MIT
#include "tests/support/box_card.hpp"

#include <algorithm>
#include <map>
#include <utility>

namespace popcut::testing {
namespace {

constexpr double kWall = 40, kGround = 30, kHeight = 24.5, kDepth = 13.3;
constexpr double kBoxBegin = 20, kBoxEnd = 45, kWidth = 70;

bool is_outside(const Pattern& pattern, const PatternVertex& a, const PatternVertex& b) {
  const double last_u = pattern.wall_mm + pattern.ground_mm;
  const auto both_u = [&](double u) { return pattern.u(a) == u && pattern.u(b) == u; };
  const auto both_v = [&](double v) { return a.v == v && b.v == v; };
  return both_u(0) || both_u(last_u) || both_v(0) || both_v(pattern.width_mm);
}

/// Edges out of the faces: shared ones are the folds, a mountain only at the box's rim.
void add_edges(Pattern& pattern) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> seen;
  for (std::size_t f = 0; f < pattern.faces(); ++f) {
    const auto face = pattern.face(f);
    for (std::size_t i = 0; i < face.size(); ++i) {
      const std::uint32_t a = face[i], b = face[(i + 1) % face.size()];
      const PatternVertex &p = pattern.vertices[a], &q = pattern.vertices[b];
      const auto [known, fresh] =
          seen.try_emplace({std::min(a, b), std::max(a, b)}, pattern.edges.size());
      if (!fresh) {
        PatternEdge& fold = pattern.edges[known->second];
        fold.right = static_cast<std::int32_t>(f);
        fold.role = p.x > 0 && p.z > 0 ? EdgeRole::Mountain : EdgeRole::Valley;
        continue;
      }
      const EdgeRole role = is_outside(pattern, p, q) ? EdgeRole::Outline : EdgeRole::Slit;
      pattern.edges.push_back({a, b, static_cast<std::int32_t>(f), -1, role});
    }
  }
}

void add_face(Pattern& pattern, std::initializer_list<std::uint32_t> corners) {
  if (pattern.face_first.empty()) pattern.face_first.push_back(0);
  pattern.face_vertices.insert(pattern.face_vertices.end(), corners);
  pattern.face_first.push_back(static_cast<std::uint32_t>(pattern.face_vertices.size()));
}

}  // namespace

Pattern row_of_boxes(int columns) {
  Pattern pattern;
  pattern.name = "box card";
  pattern.wall_mm = kWall;
  pattern.ground_mm = kGround;
  pattern.width_mm = kWidth * columns;
  const double far_u = kWall + kGround, slit0 = kWall - kHeight, slit1 = kWall + kDepth;
  const double rim = slit0 + kDepth;
  std::vector<std::uint32_t> wall, ground;
  // Wall and ground go around all boxes: the wall's outer corners first, the ground's spine last.
  pattern.vertices = {{0, kWall, 0}, {0, 0, 0}, {kGround, 0, 0}};
  wall = {0, 1};
  for (int c = 0; c < columns; ++c) {
    const double v0 = kWidth * c + kBoxBegin, v1 = kWidth * c + kBoxEnd;
    const auto n = static_cast<std::uint32_t>(pattern.vertices.size());
    pattern.vertices.insert(pattern.vertices.end(), {{0, 0, v0},
                                                     {0, 0, v1},
                                                     {0, kHeight, v0},
                                                     {0, kHeight, v1},
                                                     {kDepth, kHeight, v0},
                                                     {kDepth, kHeight, v1},
                                                     {kDepth, 0, v0},
                                                     {kDepth, 0, v1}});
    wall.insert(wall.end(), {n, n + 2, n + 3, n + 1});
    ground.insert(ground.begin(), {n + 1, n + 7, n + 6, n});
    add_face(pattern, {n + 2, n + 4, n + 5, n + 3});
    add_face(pattern, {n + 4, n + 6, n + 7, n + 5});
    pattern.lines.push_back({slit0, v0, slit1, v0, EdgeRole::Slit});
    pattern.lines.push_back({slit0, v1, slit1, v1, EdgeRole::Slit});
    pattern.lines.push_back({slit0, v0, slit0, v1, EdgeRole::Valley});
    pattern.lines.push_back({rim, v0, rim, v1, EdgeRole::Mountain});
    pattern.lines.push_back({slit1, v0, slit1, v1, EdgeRole::Valley});
    pattern.lines.push_back({kWall, v0 - kBoxBegin, kWall, v0, EdgeRole::Valley});
    pattern.lines.push_back({kWall, v1, kWall, kWidth * (c + 1), EdgeRole::Valley});
  }
  const double last_v = pattern.width_mm;
  const auto n = static_cast<std::uint32_t>(pattern.vertices.size());
  pattern.vertices.insert(pattern.vertices.end(),
                          {{0, 0, last_v}, {0, kWall, last_v}, {kGround, 0, last_v}});
  wall.insert(wall.end(), {n, n + 1});
  std::vector<std::uint32_t> around{1, 2, n + 2, n};
  around.insert(around.end(), ground.begin(), ground.end());
  for (const auto& corners : {wall, around}) {
    pattern.face_vertices.insert(pattern.face_vertices.end(), corners.begin(), corners.end());
    pattern.face_first.push_back(static_cast<std::uint32_t>(pattern.face_vertices.size()));
  }
  const auto border = [&](double u0, double v0, double u1, double v1) {
    pattern.lines.push_back({u0, v0, u1, v1, EdgeRole::Outline});
  };
  border(0, 0, far_u, 0);
  border(far_u, 0, far_u, last_v);
  border(far_u, last_v, 0, last_v);
  border(0, last_v, 0, 0);
  add_edges(pattern);
  return pattern;
}

Pattern box_card_pattern() { return row_of_boxes(1); }

Strips box_card_strips() {
  Strips strips;
  strips.v_begin = {0, kBoxBegin, kBoxEnd, kWidth};
  strips.kind = {StripKind::Margin, StripKind::Box, StripKind::Margin};
  strips.slice = {-1, 0, -1};
  strips.first_panel = {0, 2, 6, 8};
  strips.plane = {kWallPlane, kGroundPlane, kWallPlane, 2,
                  3,          kGroundPlane, kWallPlane, kGroundPlane};
  strips.level = {-1, -1, -1, 0, 0, -1, -1, -1};
  strips.x = {0, 0, kGround, 0, 0, kDepth, kDepth, kGround, 0, 0, kGround};
  strips.z = {kWall, 0, 0, kWall, kHeight, kHeight, 0, 0, kWall, 0, 0};
  return strips;
}

}  // namespace popcut::testing
