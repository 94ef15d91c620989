// SPDX-License-Identifier: MIT
#include "core/verify/sheet/tiling.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "core/geometry/cell_grid.hpp"

namespace popcut::verify {
namespace {

/// Factor of the pair budget: most pairs of triangles are separated by a quick test.
constexpr std::uint64_t kPairBudgetFactor = 16;

/// Whether a side of the counter-clockwise triangle `a` has all of `b` on its outer side.
bool beside(const std::array<Vec2, 3>& a, const std::array<Vec2, 3>& b) {
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec2 way = a[(k + 1) % 3] - a[k];
    if (cross(way, b[0] - a[k]) <= 0.0 && cross(way, b[1] - a[k]) <= 0.0 &&
        cross(way, b[2] - a[k]) <= 0.0) {
      return true;
    }
  }
  return false;
}

std::string show(Vec2 p) { return fmt::format("({:.6g}, {:.6g})", p.x(), p.y()); }

/// For each edge, a bit for a face on its left and a bit for a face on its right.
std::vector<std::uint8_t> faces_beside(const FoldModel& file, const Sheet& sheet) {
  std::vector<std::uint8_t> beside(file.edges.size(), 0);
  for (std::size_t s = 0; s < sheet.side_edge.size(); ++s) {
    if (sheet.side_edge[s] < 0) continue;
    const auto e = static_cast<std::size_t>(sheet.side_edge[s]);
    beside[e] =
        static_cast<std::uint8_t>(beside[e] | (file.edges[e][0] == file.face_vertices[s] ? 1 : 2));
  }
  return beside;
}

struct Meeting {
  enum class Kind { None, Crosses, RunsAlong, VertexInside } kind{Kind::None};
  Vec2 at{};
  std::uint32_t vertex{};  ///< an end of the second edge, inside the first edge
};

/// How edge `f` meets edge `e`; `VertexInside` looks only for ends of f inside e.
Meeting meet(const FoldModel& file, std::uint32_t e, std::uint32_t f, double slack) {
  const auto [e0, e1] = file.edges[e];
  const auto [f0, f1] = file.edges[f];
  const Vec2 a = file.flat[e0];
  const Vec2 b = file.flat[e1];
  const Vec2 c = file.flat[f0];
  const Vec2 d = file.flat[f1];
  const double length = norm(b - a);
  if (!(length > 0.0)) return {};
  const Vec2 way = (1.0 / length) * (b - a);
  const double side_c = cross(way, c - a);
  const double side_d = cross(way, d - a);
  const double along_c = dot(way, c - a);
  const double along_d = dot(way, d - a);
  if (std::abs(side_c) <= slack && std::abs(side_d) <= slack) {
    const double from = std::max(0.0, std::min(along_c, along_d));
    const double to = std::min(length, std::max(along_c, along_d));
    if (to - from > 4.0 * slack) return {Meeting::Kind::RunsAlong, a + 0.5 * (from + to) * way, 0};
    return {};
  }
  for (const auto& [vertex, side, along] :
       {std::tuple(f0, side_c, along_c), std::tuple(f1, side_d, along_d)}) {
    if (vertex == e0 || vertex == e1 || std::abs(side) > slack) continue;
    if (along > 4.0 * slack && along < length - 4.0 * slack)
      return {Meeting::Kind::VertexInside, file.flat[vertex], vertex};
  }
  if (side_c * side_d >= 0.0 || std::min(std::abs(side_c), std::abs(side_d)) <= slack) return {};
  const Vec2 other = (1.0 / norm(d - c)) * (d - c);
  const double side_a = cross(other, a - c);
  const double side_b = cross(other, b - c);
  if (side_a * side_b >= 0.0 || std::min(std::abs(side_a), std::abs(side_b)) <= slack) return {};
  return {Meeting::Kind::Crosses, c + (side_c / (side_c - side_d)) * (d - c), 0};
}

/// Whether `e` and `f` can be the two sides of one slit: borders with their faces on opposite
/// sides.
bool slit_sides(const FoldModel& file, const std::vector<std::uint8_t>& beside, std::uint32_t e,
                std::uint32_t f) {
  if (file.assignment[e] != Assignment::Border || file.assignment[f] != Assignment::Border)
    return false;
  if (beside[e] == 3 || beside[f] == 3) return false;
  const Vec2 e_way = file.flat[file.edges[e][1]] - file.flat[file.edges[e][0]];
  const Vec2 f_way = file.flat[file.edges[f][1]] - file.flat[file.edges[f][0]];
  return (dot(e_way, f_way) > 0.0) == (beside[e] != beside[f]);
}

const char* line_name(Assignment a) {
  return a == Assignment::Border ? "border" : a == Assignment::Cut ? "cut" : "fold";
}

}  // namespace

Triangles check_faces(const FoldModel& file, VerifyCheck& check) {
  Triangles result;
  result.first.assign(1, 0);
  for (std::uint32_t f = 0; f < file.faces(); ++f) {
    const double size = area(file, f);
    const std::size_t before = result.corners.size();
    if (size < 0.0) {
      check.fail(face_place(f),
                 fmt::format("the face runs clockwise (area {:.6g} mm2); faces must run "
                             "counter-clockwise",
                             size));
    } else if (size == 0.0) {
      check.fail(face_place(f), "the face has no area");
    } else if (!triangulate(file.flat, face_of(file, f), result.corners)) {
      check.fail(face_place(f), "the face crosses itself; it must be a simple polygon");
      result.corners.resize(before);
    }
    result.face.resize(result.corners.size(), f);
    result.first.push_back(static_cast<std::uint32_t>(result.corners.size()));
  }
  return result;
}

Tiling check_tiling(const FoldModel& file, const Sheet& sheet, const Triangles& triangles,
                    double slack_mm, VerifyCheck& check) {
  Tiling tiling;
  const Vec2 start = file.flat[file.face_vertices.front()];
  Vec2 low = start, high = start;
  for (const std::uint32_t v : file.face_vertices) {
    low = low.cwiseMin(file.flat[v]);
    high = high.cwiseMax(file.flat[v]);
  }
  tiling.sheet_u_mm = high.x() - low.x();
  tiling.sheet_v_mm = high.y() - low.y();

  // 1. No two faces overlap: their triangles share no significant area.
  const auto corners = [&](std::size_t t) {
    const Triangle& c = triangles.corners[t];
    return std::array<Vec2, 3>{file.flat[c[0]], file.flat[c[1]], file.flat[c[2]]};
  };
  std::map<std::pair<std::uint32_t, std::uint32_t>, double> overlaps;
  std::set<std::pair<std::uint32_t, std::uint32_t>> counted;
  const auto face_of_triangle = [&](std::uint32_t t) { return triangles.face[t]; };
  const CellGrid grid(triangles.corners.size(), slack_mm, corners);
  const bool all = grid.each_pair_of_groups(
      kPairBudgetFactor * pair_budget(triangles.corners.size()), face_of_triangle,
      [&](std::uint32_t i, std::uint32_t j) {
        if (overlaps.size() > kMostReported) return;
        const auto a = corners(i);
        const auto b = corners(j);
        if (beside(a, b) || beside(b, a)) return;
        const double common = common_area(a, b);
        const auto reach = [](const std::array<Vec2, 3>& t) {
          return std::max({norm(t[1] - t[0]), norm(t[2] - t[1]), norm(t[0] - t[2])});
        };
        if (common <= 4.0 * slack_mm * (slack_mm + std::min(reach(a), reach(b)))) return;
        if (counted.emplace(i, j).second)
          overlaps[std::minmax(triangles.face[i], triangles.face[j])] += common;
      });
  for (const auto& [faces, common] : overlaps)
    check.fail(face_place(faces.second),
               fmt::format("it overlaps face {} by {:.6g} mm2", faces.first, common));

  // 2. Their areas add up to the sheet's.
  for (std::size_t f = 0; f < file.faces(); ++f) tiling.area_mm2 += std::abs(area(file, f));
  double outline_mm2 = 0.0, holes_mm2 = 0.0;  // inside the outer borders, and in holes
  for (const BorderLoop& border : border_loops(file, sheet)) {
    const double loop = border.area_mm2;
    const double nothing = 4.0 * slack_mm * border.length_mm;
    if (std::abs(loop) <= nothing) {
      ++tiling.slits;
    } else if (loop > 0.0) {
      outline_mm2 += loop;
    } else {
      holes_mm2 -= loop;
      ++tiling.holes;
    }
  }
  const double missing = outline_mm2 - holes_mm2 - tiling.area_mm2;
  const double lines = 4.0 * slack_mm * static_cast<double>(file.edges.size()) *
                       (tiling.sheet_u_mm + tiling.sheet_v_mm);
  if (std::abs(missing) > std::min(lines, 1e-6 * tiling.area_mm2))
    check.fail(
        "/faces_vertices",
        fmt::format("the faces have {:.6f} mm2, but the border encloses {:.6f} mm2 minus {:.6f} "
                    "mm2 of holes",
                    tiling.area_mm2, outline_mm2, holes_mm2));
  check.detail = fmt::format("{} faces of {:.6g} mm2 tile {:.6g} x {:.6g} mm, {} slits, {} holes",
                             file.faces(), tiling.area_mm2, tiling.sheet_u_mm, tiling.sheet_v_mm,
                             tiling.slits, tiling.holes);
  if (!all)
    check.not_judged("too many faces lie in one place to compare them; their total area is right");
  return tiling;
}

void check_lines(const FoldModel& file, const Sheet& sheet, double slack_mm, VerifyCheck& check) {
  const std::vector<std::uint8_t> beside = faces_beside(file, sheet);
  const auto ends = [&](std::size_t e) {
    return std::array<Vec2, 2>{file.flat[file.edges[e][0]], file.flat[file.edges[e][1]]};
  };
  std::set<std::pair<std::uint32_t, std::uint32_t>> reported;
  const auto once = [&](std::uint32_t e, std::uint32_t f) {
    return reported.size() <= kMostReported &&
           reported.emplace(std::min(e, f), std::max(e, f)).second;
  };
  const auto vertex_inside = [&](std::uint32_t e, const Meeting& m, std::uint32_t f) {
    if (file.assignment[e] == Assignment::Border || !once(e, f)) return;
    check.fail(edge_place(e),
               fmt::format("vertex {} at {} lies inside this {}; split the line there", m.vertex,
                           show(m.at), line_name(file.assignment[e])));
  };
  const CellGrid grid(file.edges.size(), slack_mm, ends);
  const bool all =
      grid.each_pair(pair_budget(file.edges.size()), [&](std::uint32_t e, std::uint32_t f) {
        const Meeting m = meet(file, e, f, slack_mm);
        const Meeting back = m.kind == Meeting::Kind::None ? meet(file, f, e, slack_mm) : Meeting{};
        if (m.kind == Meeting::Kind::Crosses && once(e, f)) {
          check.fail(edge_place(f),
                     fmt::format("it crosses edge {} at {} without a vertex", e, show(m.at)));
        } else if (m.kind == Meeting::Kind::RunsAlong || back.kind == Meeting::Kind::RunsAlong) {
          if (slit_sides(file, beside, e, f) || !once(e, f)) return;
          check.fail(edge_place(f),
                     fmt::format("the {} runs along the {} of edge {} at {}; draw each line once",
                                 line_name(file.assignment[f]), line_name(file.assignment[e]), e,
                                 show(m.kind == Meeting::Kind::RunsAlong ? m.at : back.at)));
        } else if (m.kind == Meeting::Kind::VertexInside) {
          vertex_inside(e, m, f);
        } else if (back.kind == Meeting::Kind::VertexInside) {
          vertex_inside(f, back, e);
        }
      });
  std::size_t folds = 0;
  std::size_t borders = 0;
  for (const Assignment a : file.assignment) ++(holds(a) ? folds : borders);
  check.detail = fmt::format(
      "{} folds, {} borders and sides of cuts; no line crosses or repeats another", folds, borders);
  if (!check.ok()) check.detail = fmt::format("{} wrong", check.failed);
  if (!all) check.not_judged("too many edges lie in one place to compare them");
}

}  // namespace popcut::verify
