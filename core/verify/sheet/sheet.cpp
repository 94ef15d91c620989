// SPDX-License-Identifier: MIT
#include "core/verify/sheet/sheet.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "core/geometry/buckets.hpp"
#include "core/geometry/disjoint_sets.hpp"

namespace popcut::verify {
namespace {

/// Edges by their two ends.
class EdgeIndex {
 public:
  explicit EdgeIndex(const FoldModel& file) {
    entries_.reserve(file.edges.size());
    for (std::uint32_t e = 0; e < file.edges.size(); ++e)
      entries_.emplace_back(key(file.edges[e][0], file.edges[e][1]), e);
    std::sort(entries_.begin(), entries_.end());
  }
  /// The first edge between two vertices, -1 for none.
  [[nodiscard]] std::int32_t find(std::uint32_t a, std::uint32_t b) const {
    const auto at = std::lower_bound(entries_.begin(), entries_.end(), std::pair(key(a, b), 0U));
    return at != entries_.end() && at->first == key(a, b) ? static_cast<std::int32_t>(at->second)
                                                          : -1;
  }
  /// Calls `visit(e, f)` for each edge `f` that repeats an earlier edge `e`.
  template <typename Visit>
  void each_repeat(Visit visit) const {
    for (std::size_t i = 1; i < entries_.size(); ++i) {
      if (entries_[i].first == entries_[i - 1].first)
        visit(entries_[i - 1].second, entries_[i].second);
    }
  }

 private:
  static std::uint64_t key(std::uint32_t a, std::uint32_t b) {
    return (static_cast<std::uint64_t>(std::min(a, b)) << 32) | std::max(a, b);
  }
  std::vector<std::pair<std::uint64_t, std::uint32_t>> entries_;
};

const char* kind(Assignment a) {
  switch (a) {
    case Assignment::Mountain:
      return "mountain fold";
    case Assignment::Valley:
      return "valley fold";
    case Assignment::Flat:
    case Assignment::Join:
      return "flat crease";
    case Assignment::Border:
      return "border";
    case Assignment::Cut:
      return "cut";
    case Assignment::Unassigned:
      break;
  }
  return "unassigned edge";
}

/// The two sides of an edge, running with it and against it; -1: none.
using Sides = std::array<std::int32_t, 2>;

std::vector<Sides> sides_of_edges(const FoldModel& file, const EdgeIndex& index, Sheet& sheet,
                                  VerifyCheck& check) {
  std::vector<Sides> sides(file.edges.size(), Sides{-1, -1});
  const std::size_t count = file.face_vertices.size();
  sheet.side_face.resize(count);
  sheet.side_edge.assign(count, -1);
  sheet.side_twin.assign(count, -1);
  for (std::uint32_t f = 0; f < file.faces(); ++f) {
    const std::uint32_t first = file.face_first[f];
    const std::uint32_t past = file.face_first[f + 1];
    for (std::uint32_t s = first; s < past; ++s) {
      sheet.side_face[s] = f;
      const std::uint32_t a = file.face_vertices[s];
      const std::uint32_t b = file.face_vertices[s + 1 == past ? first : s + 1];
      const std::int32_t e = index.find(a, b);
      sheet.side_edge[s] = e;
      if (e < 0) {
        check.fail(face_place(f),
                   fmt::format("its side from vertex {} to {} is not an edge", a, b));
        continue;
      }
      const auto edge = static_cast<std::uint32_t>(e);
      const std::size_t way = file.edges[edge][0] == a ? 0 : 1;
      if (sides[edge][way] >= 0) {
        const std::uint32_t other = sheet.side_face[static_cast<std::uint32_t>(sides[edge][way])];
        check.fail(edge_place(edge), fmt::format("faces {} and {} are both on the same side of it; "
                                                 "one overlaps the other or runs the wrong way",
                                                 other, f));
        continue;
      }
      sides[edge][way] = static_cast<std::int32_t>(s);
    }
  }
  return sides;
}

void link(const FoldModel& file, const std::vector<Sides>& sides, Sheet& sheet,
          VerifyCheck& check) {
  for (std::uint32_t e = 0; e < file.edges.size(); ++e) {
    const Assignment a = file.assignment[e];
    const int used = (sides[e][0] >= 0 ? 1 : 0) + (sides[e][1] >= 0 ? 1 : 0);
    if (used == 0) {
      check.fail(edge_place(e), fmt::format("the {} bounds no face; it is outside the sheet or "
                                            "inside a face",
                                            kind(a)));
    } else if (used == 1 && holds(a) && (a != Assignment::Unassigned || file.from_popcut)) {
      const auto s = static_cast<std::uint32_t>(std::max(sides[e][0], sides[e][1]));
      check.fail(edge_place(e), fmt::format("the {} has only one face, face {}; add the missing "
                                            "face, or make it a border (B)",
                                            kind(a), sheet.side_face[s]));
    }
    if (used == 2 && a == Assignment::Border && !file.drawn) {
      const auto left = static_cast<std::uint32_t>(sides[e][0]);
      const auto right = static_cast<std::uint32_t>(sides[e][1]);
      check.fail(
          edge_place(e),
          fmt::format("the border has two faces, {} and {}; use C for a cut between two faces, "
                      "M or V for a fold",
                      sheet.side_face[left], sheet.side_face[right]));
    }
    if (used != 2 || !holds(a)) continue;
    const auto left = static_cast<std::uint32_t>(sides[e][0]);
    const auto right = static_cast<std::uint32_t>(sides[e][1]);
    sheet.side_twin[left] = sides[e][1];
    sheet.side_twin[right] = sides[e][0];
    const Hinge hinge{e, file.edges[e][0], file.edges[e][1], sheet.side_face[left],
                      sheet.side_face[right]};
    if (hinge.left == hinge.right && joins(a))
      continue;  // connects a hole to the border of its face
    if (hinge.left == hinge.right) {
      check.fail(edge_place(e),
                 fmt::format("the {} has face {} on both sides; a fold must separate two "
                             "faces",
                             kind(a), hinge.left));
      continue;
    }
    sheet.hinges.push_back(hinge);
  }
}

}  // namespace

double area(const FoldModel& file, std::size_t f) {
  const auto corners = face_of(file, f);
  const Vec2 origin = file.flat[corners[0]];
  double twice = 0.0;
  for (std::size_t k = 1; k + 1 < corners.size(); ++k)
    twice += cross(file.flat[corners[k]] - origin, file.flat[corners[k + 1]] - origin);
  return 0.5 * twice;
}

Sheet make_sheet(const FoldModel& file, VerifyCheck& check) {
  Sheet sheet;
  const EdgeIndex index(file);
  index.each_repeat([&](std::uint32_t e, std::uint32_t again) {
    check.fail(edge_place(again),
               fmt::format("it joins the same vertices as edge {}; list each line of the "
                           "sheet once",
                           e));
  });
  const std::vector<Sides> sides = sides_of_edges(file, index, sheet, check);
  link(file, sides, sheet, check);
  DisjointSets panels(file.faces());
  DisjointSets pieces(file.faces());
  for (const Hinge& hinge : sheet.hinges) {
    pieces.join(hinge.left, hinge.right);
    if (joins(file.assignment[hinge.edge])) panels.join(hinge.left, hinge.right);
  }
  sheet.panels = panels.number(sheet.panel_of_face);
  sheet.pieces = pieces.number(sheet.piece_of_face);
  return sheet;
}

std::size_t part_at_cuts(FoldModel& file, const Sheet& sheet) {
  const std::size_t corners = file.face_vertices.size();
  // Corners of faces, numbered as the sides that leave them, by what hangs together at a vertex.
  DisjointSets fans(corners);
  for (std::uint32_t s = 0; s < corners; ++s) {
    if (sheet.side_twin[s] < 0) continue;
    fans.join(s, sheet.next(file, static_cast<std::uint32_t>(sheet.side_twin[s])));
  }
  // 1. The first fan of a vertex keeps it, the others get copies.
  constexpr std::uint32_t kNone = 0xffffffffU;
  const std::size_t before = file.flat.size();
  std::vector<std::uint32_t> keeps(before, kNone);  // the root of the fan that keeps the vertex
  std::vector<std::uint32_t> vertex(corners);
  std::vector<std::uint32_t> origin;  // original vertex of each copy
  std::vector<std::uint32_t> copy_of_root(corners, kNone);
  for (std::uint32_t s = 0; s < corners; ++s) {
    const std::uint32_t v = file.face_vertices[s];
    const std::uint32_t root = fans.find(s);
    if (keeps[v] == kNone) keeps[v] = root;
    if (keeps[v] == root) {
      vertex[s] = v;
      continue;
    }
    if (copy_of_root[root] == kNone) {
      copy_of_root[root] = static_cast<std::uint32_t>(before + origin.size());
      origin.push_back(v);
    }
    vertex[s] = copy_of_root[root];
  }
  if (origin.empty()) return 0;
  for (const std::uint32_t v : origin) {
    file.flat.push_back(file.flat[v]);
    for (Pose& pose : file.poses) pose.at.push_back(pose.at[v]);
  }
  // 2. Edges follow their faces; the second side of a cut becomes a separate edge.
  const std::size_t edges = file.edges.size();
  std::vector<std::uint8_t> placed(edges, 0);
  for (std::uint32_t s = 0; s < corners; ++s) {
    if (sheet.side_edge[s] < 0) continue;
    const auto e = static_cast<std::size_t>(sheet.side_edge[s]);
    std::array<std::uint32_t, 2> ends{vertex[s], vertex[sheet.next(file, s)]};
    const std::uint32_t first_end = placed[e] == 0 ? file.edges[e][0] : kNone;
    if (placed[e] == 0) {
      if (file.face_vertices[s] != first_end) std::swap(ends[0], ends[1]);
      file.edges[e] = ends;
      placed[e] = 1;
      continue;
    }
    const auto [a, b] = file.edges[e];
    if (holds(file.assignment[e]) || std::minmax(ends[0], ends[1]) == std::minmax(a, b)) continue;
    file.assignment[e] = Assignment::Border;
    file.edges.push_back(ends);
    file.assignment.push_back(Assignment::Border);
    if (!file.fold_angle_deg.empty()) file.fold_angle_deg.push_back(0.0);
    for (Pose& pose : file.poses) {
      if (!pose.fold_angle_deg.empty()) pose.fold_angle_deg.push_back(0.0);
    }
  }
  file.face_vertices = std::move(vertex);
  return origin.size();
}

std::vector<BorderLoop> border_loops(const FoldModel& file, const Sheet& sheet) {
  std::vector<BorderLoop> loops;
  std::vector<std::uint8_t> seen(sheet.side_twin.size(), 0);
  for (std::uint32_t start = 0; start < seen.size(); ++start) {
    if (sheet.side_twin[start] >= 0 || seen[start] != 0) continue;
    const Vec2 origin = file.flat[file.face_vertices[start]];
    double twice = 0.0, length_mm = 0.0;
    // Along the border; at each of its vertices across the folds to the next border side.
    for (std::uint32_t side = start; seen[side] == 0;) {
      seen[side] = 1;
      std::uint32_t after = sheet.next(file, side);
      const Vec2 from = file.flat[file.face_vertices[side]],
                 to = file.flat[file.face_vertices[after]];
      twice += cross(from - origin, to - origin);
      length_mm += norm(to - from);
      while (sheet.side_twin[after] >= 0)
        after = sheet.next(file, static_cast<std::uint32_t>(sheet.side_twin[after]));
      side = after;
    }
    loops.push_back({start, 0.5 * twice, length_mm});
  }
  return loops;
}

void trace_faces(FoldModel& file) {
  // Half-edge 2e runs with edge e, 2e + 1 against it. The half-edges that leave a vertex are sorted
  // by angle. After arriving by h, the one clockwise of its twin keeps the face on the left.
  const std::size_t halves = 2 * file.edges.size();
  const auto from = [&](std::size_t h) { return file.edges[h / 2][h % 2]; };
  Buckets<std::uint32_t> leaving(file.flat.size(), [&](auto&& put) {
    for (std::uint32_t h = 0; h < halves; ++h) put(from(h), h);
  });
  std::vector<double> angle(halves);
  for (std::uint32_t h = 0; h < halves; ++h) {
    const Vec2 way = file.flat[from(h ^ 1U)] - file.flat[from(h)];
    angle[h] = std::atan2(way.y(), way.x());
  }
  std::vector<std::uint32_t> clockwise(halves);
  for (std::size_t vertex = 0; vertex < file.flat.size(); ++vertex) {
    const auto around = leaving[vertex];
    std::sort(around.begin(), around.end(), [&](std::uint32_t a, std::uint32_t b) {
      return std::pair(angle[a], a) < std::pair(angle[b], b);
    });
    for (std::size_t k = 0; k < around.size(); ++k)
      clockwise[around[k]] = around[k == 0 ? around.size() - 1 : k - 1];
  }

  file.face_first.assign(1, 0);
  file.face_vertices.clear();
  std::vector<std::uint8_t> seen(halves, 0);
  for (std::uint32_t start = 0; start < halves; ++start) {
    double twice = 0.0;
    const Vec2 origin = file.flat[from(start)];
    for (std::uint32_t h = start; seen[h] == 0; h = clockwise[h ^ 1U]) {
      seen[h] = 1;
      file.face_vertices.push_back(from(h));
      twice += cross(file.flat[from(h)] - origin, file.flat[from(h ^ 1U)] - origin);
    }
    if (twice > 0.0) {
      file.face_first.push_back(static_cast<std::uint32_t>(file.face_vertices.size()));
    } else {
      file.face_vertices.resize(file.face_first.back());
    }
  }
}

}  // namespace popcut::verify
