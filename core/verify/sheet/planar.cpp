// SPDX-License-Identifier: MIT
#include "core/verify/sheet/planar.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "core/geometry/cell_grid.hpp"
#include "core/geometry/disjoint_sets.hpp"
#include "core/geometry/interval_bins.hpp"
#include "core/geometry/node_index.hpp"
#include "core/verify/sheet/sheet.hpp"

namespace popcut::verify {
namespace {

constexpr double kLargestShare =
    3e-3;  ///< of the drawing's size: largest gap between ends that belong together
constexpr double kSmallestShare = 1e-7;
constexpr std::size_t kCrossingsAnEdge = 50;
constexpr std::size_t kMostTieWork = 300'000'000;  ///< limit of edges examined for islands

/// Points closer than a tolerance are one: the nearest that is there.
class PointIndex {
 public:
  PointIndex(std::size_t expected, double tolerance)
      : tolerance_(tolerance), nodes_(tolerance, expected) {}

  std::uint32_t add(const Vec2& p) {
    const PagePoint at{p.x(), p.y()};
    const std::uint32_t found = nodes_.find(at, tolerance_);
    if (found != NodeIndex::kNone) {
      moved = std::max(moved, norm(points[found] - p));
      return found;
    }
    points.push_back(p);
    return nodes_.add(at);
  }

  std::vector<Vec2> points;
  double moved{};  ///< largest distance that a point was moved

 private:
  double tolerance_;
  NodeIndex nodes_;
};

struct GraphEdge {
  std::uint32_t a{}, b{};
  Assignment kind{};
  double fold_angle_deg{};
};

struct Graph {
  std::vector<Vec2> points;
  std::vector<GraphEdge> edges;
  double moved_mm{};
  std::size_t crossings{}, doubled{}, loose_folds{};
  bool complete{true};
};

/// Which of two overlapping lines stays: cuts before folds before flat creases.
int weight(Assignment kind) {
  if (!holds(kind)) return 3;
  if (kind == Assignment::Mountain || kind == Assignment::Valley) return 2;
  return kind == Assignment::Unassigned ? 1 : 0;
}

/// Splits edges where others meet or cross them.
class Splitter {
 public:
  Splitter(PointIndex& index, const std::vector<GraphEdge>& edges, double tolerance)
      : index_(index), edges_(edges), tolerance_(tolerance), on_(edges.size()) {}

  bool run(std::size_t& crossings) {
    const std::vector<Vec2> ends =
        index_.points;  // a copy: crossings are added to the index meanwhile
    const auto corners = [&](std::size_t e) {
      return std::array<Vec2, 2>{ends[edges_[e].a], ends[edges_[e].b]};
    };
    const CellGrid grid(edges_.size(), tolerance_, corners);
    bool few = true;
    const bool all =
        grid.each_pair(4 * pair_budget(edges_.size()), [&](std::uint32_t e, std::uint32_t f) {
          if (!few) return;
          meet(e, f, crossings);
          few = index_.points.size() - ends.size() <= kCrossingsAnEdge * edges_.size() + 1000;
        });
    return all && few;
  }

  /// The parts of edge `e`, from point to point.
  std::vector<std::uint32_t> points_on(std::size_t e) {
    std::vector<std::uint32_t>& on = on_[e];
    const Vec2 a = index_.points[edges_[e].a];
    const Vec2 way = index_.points[edges_[e].b] - a;
    std::sort(on.begin(), on.end(), [&](std::uint32_t p, std::uint32_t q) {
      return std::pair(dot(way, index_.points[p] - a), p) <
             std::pair(dot(way, index_.points[q] - a), q);
    });
    on.erase(std::unique(on.begin(), on.end()), on.end());
    std::vector<std::uint32_t> row{edges_[e].a};
    for (const std::uint32_t p : on) {
      if (p != edges_[e].a && p != edges_[e].b) row.push_back(p);
    }
    row.push_back(edges_[e].b);
    return row;
  }

 private:
  void meet(std::uint32_t e, std::uint32_t f, std::size_t& crossings) {
    const bool touched = touch(e, f);
    if (touch(f, e) || touched) return;
    const auto [a, b] = ends(e);
    const auto [c, d] = ends(f);
    const Vec2 p = b - a;
    const Vec2 q = d - c;
    const double turn = cross(p, q);
    if (turn == 0.0) return;
    const double s = cross(c - a, q) / turn;
    const double t = cross(c - a, p) / turn;
    if (!(s > 0.0 && s < 1.0 && t > 0.0 && t < 1.0)) return;
    const std::size_t before = index_.points.size();
    const std::uint32_t at = index_.add(a + s * p);
    if (index_.points.size() > before) ++crossings;
    on_[e].push_back(at);
    on_[f].push_back(at);
  }

  /// Finds ends of `f` that lie on `e`; returns whether there are any, including shared ends.
  bool touch(std::uint32_t e, std::uint32_t f) {
    const auto [a, b] = ends(e);
    const Vec2 way = b - a;
    const double length = norm(way);
    bool any = false;
    for (const std::uint32_t v : {edges_[f].a, edges_[f].b}) {
      if (v == edges_[e].a || v == edges_[e].b) {
        any = true;
        continue;
      }
      const Vec2 p = index_.points[v];
      const double along = dot(way, p - a) / length;
      if (along <= 0.0 || along >= length || std::abs(cross(way, p - a)) > tolerance_ * length)
        continue;
      index_.moved = std::max(index_.moved, std::abs(cross(way, p - a)) / length);
      on_[e].push_back(v);
      any = true;
    }
    return any;
  }

  [[nodiscard]] std::pair<Vec2, Vec2> ends(std::uint32_t e) const {
    return {index_.points[edges_[e].a], index_.points[edges_[e].b]};
  }

  PointIndex& index_;
  const std::vector<GraphEdge>& edges_;
  double tolerance_;
  std::vector<std::vector<std::uint32_t>> on_;
};

std::size_t loose_folds(const Graph& graph) {
  std::vector<std::uint32_t> degree(graph.points.size(), 0);
  for (const GraphEdge& edge : graph.edges) ++degree[edge.a], ++degree[edge.b];
  std::size_t loose = 0;
  for (const GraphEdge& edge : graph.edges) {
    if (!holds(edge.kind)) continue;
    loose += (degree[edge.a] == 1 ? 1U : 0U) + (degree[edge.b] == 1 ? 1U : 0U);
  }
  return loose;
}

Graph graph_of(const std::vector<DrawnEdge>& lines, double tolerance) {
  Graph graph;
  PointIndex index(2 * lines.size(), tolerance);
  std::vector<GraphEdge> edges;
  edges.reserve(lines.size());
  for (const DrawnEdge& line : lines) {
    const std::uint32_t a = index.add(line.from);
    const std::uint32_t b = index.add(line.to);
    if (a != b) edges.push_back({a, b, line.kind, line.fold_angle_deg});
  }
  Splitter splitter(index, edges, tolerance);
  graph.complete = splitter.run(graph.crossings);
  if (!graph.complete) return graph;
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const auto row = splitter.points_on(e);
    for (std::size_t k = 1; k < row.size(); ++k) {
      GraphEdge part = edges[e];
      part.a = row[k - 1], part.b = row[k];
      graph.edges.push_back(part);
    }
  }
  const auto key = [](const GraphEdge& e) { return std::minmax(e.a, e.b); };
  std::stable_sort(graph.edges.begin(), graph.edges.end(),
                   [&](const GraphEdge& x, const GraphEdge& y) {
                     return std::pair(key(x), -weight(x.kind)) < std::pair(key(y), -weight(y.kind));
                   });
  const auto past =
      std::unique(graph.edges.begin(), graph.edges.end(),
                  [&](const GraphEdge& x, const GraphEdge& y) { return key(x) == key(y); });
  graph.doubled = static_cast<std::size_t>(graph.edges.end() - past);
  graph.edges.erase(past, graph.edges.end());
  graph.points = std::move(index.points);
  graph.moved_mm = index.moved;
  graph.loose_folds = loose_folds(graph);
  return graph;
}

/// Connects separate parts of the drawing to the line on their left (towards smaller u) by a flat
/// edge.
std::size_t tie_islands(Graph& graph, double tolerance) {
  const std::size_t n = graph.points.size();
  DisjointSets islands(n);
  for (const GraphEdge& edge : graph.edges) islands.join(edge.a, edge.b);
  // The point of each island with the smallest u.
  std::vector<std::uint32_t> tip(n, 0xffffffffU);
  std::vector<std::uint8_t> used(n, 0);
  for (const GraphEdge& edge : graph.edges) used[edge.a] = used[edge.b] = 1;
  for (std::uint32_t v = 0; v < n; ++v) {
    if (used[v] == 0) continue;
    std::uint32_t& at = tip[islands.find(v)];
    if (at == 0xffffffffU || graph.points[v].x() < graph.points[at].x()) at = v;
  }
  std::vector<std::uint32_t> tips;
  for (std::uint32_t v = 0; v < n; ++v)
    if (tip[v] != 0xffffffffU) tips.push_back(tip[v]);
  if (tips.size() < 2) return 0;
  // Edges by rows of v.
  double low = graph.points[tips[0]].y(), high = low;
  for (const Vec2& p : graph.points) low = std::min(low, p.y()), high = std::max(high, p.y());
  std::vector<std::uint32_t> all(graph.edges.size());
  std::iota(all.begin(), all.end(), 0U);
  const IntervalBins rows(low, high, 4096, all, [&](std::uint32_t e) {
    return std::pair<double, double>(
        std::minmax(graph.points[graph.edges[e].a].y(), graph.points[graph.edges[e].b].y()));
  });
  struct Tie {
    std::uint32_t tip{}, edge{};
    Vec2 at;
  };
  std::vector<Tie> ties;
  std::size_t work = 0;
  for (const std::uint32_t v : tips) {
    const Vec2 p = graph.points[v];
    work += rows.at(p.y()).size();
    if (work > kMostTieWork) break;
    Tie best{v, 0xffffffffU, {}};
    for (const std::uint32_t e : rows.at(p.y())) {
      const Vec2 a = graph.points[graph.edges[e].a];
      const Vec2 b = graph.points[graph.edges[e].b];
      if ((a.y() < p.y()) == (b.y() < p.y())) continue;
      const Vec2 at = a + ((p.y() - a.y()) / (b.y() - a.y())) * (b - a);
      if (at.x() >= p.x() || islands.find(graph.edges[e].a) == islands.find(v)) continue;
      if (best.edge == 0xffffffffU || at.x() > best.at.x()) best = {v, e, at};
    }
    if (best.edge != 0xffffffffU) ties.push_back(best);
  }
  // Splits the edges that ties meet, starting from their far ends.
  std::sort(ties.begin(), ties.end(), [&](const Tie& x, const Tie& y) {
    const Vec2 a = graph.points[graph.edges[x.edge].a];
    return std::pair(x.edge, x.edge == y.edge ? -norm(x.at - a) : 0.0) <
           std::pair(y.edge,
                     x.edge == y.edge ? -norm(y.at - graph.points[graph.edges[y.edge].a]) : 0.0);
  });
  for (const Tie& tie : ties) {
    GraphEdge& met = graph.edges[tie.edge];
    const auto here = [&](std::uint32_t v) { return norm(graph.points[v] - tie.at) <= tolerance; };
    if (here(met.a) || here(met.b)) {
      const std::uint32_t end = here(met.a) ? met.a : met.b;
      graph.edges.push_back({end, tie.tip, Assignment::Join, 0.0});
      continue;
    }
    const auto mid = static_cast<std::uint32_t>(graph.points.size());
    graph.points.push_back(tie.at);
    GraphEdge rest = graph.edges[tie.edge];
    rest.a = mid;
    graph.edges[tie.edge].b = mid;
    graph.edges.push_back(rest);
    graph.edges.push_back({mid, tie.tip, Assignment::Join, 0.0});
  }
  return ties.size();
}

/// Removes edges that bound no face, except folds, which the user must see.
std::size_t drop_idle(FoldModel& file) {
  VerifyCheck scratch;
  const Sheet sheet = make_sheet(file, scratch);
  std::vector<std::uint8_t> used(file.edges.size(), 0);
  for (const std::int32_t e : sheet.side_edge)
    if (e >= 0) used[static_cast<std::size_t>(e)] = 1;
  std::size_t kept = 0;
  std::size_t cuts = 0;
  for (std::size_t e = 0; e < file.edges.size(); ++e) {
    const Assignment kind = file.assignment[e];
    if (used[e] == 0 && (!holds(kind) || joins(kind))) {
      cuts += holds(kind) ? 0 : 1;
      continue;
    }
    file.edges[kept] = file.edges[e];
    file.assignment[kept] = kind;
    if (!file.fold_angle_deg.empty()) file.fold_angle_deg[kept] = file.fold_angle_deg[e];
    ++kept;
  }
  file.edges.resize(kept);
  file.assignment.resize(kept);
  if (!file.fold_angle_deg.empty()) file.fold_angle_deg.resize(kept);
  return cuts;
}

/// Pieces without folds, except the largest, are not part of the sheet: cuts surround them.
std::size_t drop_offcuts(FoldModel& file) {
  VerifyCheck scratch;
  const Sheet sheet = make_sheet(file, scratch);
  std::vector<double> size(sheet.pieces, 0.0);
  std::vector<std::uint8_t> folds(sheet.pieces, 0);
  for (std::size_t f = 0; f < file.faces(); ++f) size[sheet.piece_of_face[f]] += area(file, f);
  for (const Hinge& hinge : sheet.hinges) folds[sheet.piece_of_face[hinge.left]] = 1;
  const auto largest =
      static_cast<std::size_t>(std::max_element(size.begin(), size.end()) - size.begin());
  std::vector<std::uint32_t> first{0};
  std::vector<std::uint32_t> vertices;
  for (std::size_t f = 0; f < file.faces(); ++f) {
    const std::uint32_t piece = sheet.piece_of_face[f];
    if (folds[piece] == 0 && piece != largest) continue;
    for (const std::uint32_t v : face_of(file, f)) vertices.push_back(v);
    first.push_back(static_cast<std::uint32_t>(vertices.size()));
  }
  const std::size_t dropped = file.faces() + 1 - first.size();
  file.face_first = std::move(first);
  file.face_vertices = std::move(vertices);
  return dropped;
}

std::vector<DrawnEdge> drawn_edges(const FoldModel& file) {
  std::vector<DrawnEdge> lines;
  lines.reserve(file.edges.size());
  for (std::size_t e = 0; e < file.edges.size(); ++e) {
    const auto [a, b] = file.edges[e];
    lines.push_back({file.flat[a], file.flat[b], file.assignment[e],
                     file.fold_angle_deg.empty() ? 0.0 : file.fold_angle_deg[e]});
  }
  return lines;
}

}  // namespace

Result<void> planarise(FoldModel& file) {
  std::vector<DrawnEdge> lines = drawn_edges(file);
  const JoinedDashes dashes = join_dashes(lines);
  Eigen::AlignedBox2d box;
  for (const DrawnEdge& line : lines) box.extend(line.from).extend(line.to);
  // 1. The smallest tolerance that leaves the fewest loose folds.
  const double reach = std::max(norm(box.sizes()), 1e-9);
  std::optional<Graph> best;
  for (double share = kSmallestShare; share <= kLargestShare * 1.001; share *= std::sqrt(10.0)) {
    Graph graph = graph_of(lines, share * reach);
    if (!graph.complete) {
      if (best) break;
      return fail(ErrorKind::OutOfRange, "/edges_vertices",
                  "too many lines cross or overlap in one place; draw each line once");
    }
    if (!best || graph.loose_folds < best->loose_folds) best = std::move(graph);
    if (best->loose_folds == 0) break;
  }
  // 2. Faces.
  const std::size_t islands = tie_islands(*best, kSmallestShare * reach);
  const bool has_angles = !file.fold_angle_deg.empty();
  file.flat = std::move(best->points);
  file.edges.clear(), file.assignment.clear(), file.fold_angle_deg.clear(), file.poses.clear();
  for (const GraphEdge& edge : best->edges) {
    file.edges.push_back({edge.a, edge.b});
    file.assignment.push_back(edge.kind);
    if (has_angles) file.fold_angle_deg.push_back(edge.fold_angle_deg);
  }
  trace_faces(file);
  const std::size_t offcuts = drop_offcuts(file);
  const std::size_t outside = drop_idle(file);
  file.drawn = true;
  file.moved_mm = best->moved_mm;
  // 3. Notes on what was done.
  const auto note = [&](std::size_t count, std::string text) {
    if (count > 0) file.notes.push_back(std::move(text));
  };
  note(dashes.joined,
       fmt::format("folds are drawn as dashes: {} gaps of about {:.3g} mm were closed; "
                   "folds too short for a dash are missing from such a drawing",
                   dashes.joined, dashes.gap_mm));
  note(best->moved_mm > 1e-6 * reach ? 1 : 0,
       fmt::format("line ends that did not quite meet were moved by up to {:.2g} mm",
                   best->moved_mm));
  note(best->crossings, fmt::format("{} crossings of lines became vertices", best->crossings));
  note(best->doubled, fmt::format("{} lines are drawn twice and count once", best->doubled));
  note(islands, fmt::format("{} parts of the drawing lie inside a face without touching its border",
                            islands));
  note(offcuts, fmt::format("{} areas surrounded by cuts fall out and are holes", offcuts));
  note(outside, fmt::format("{} cuts outside the sheet are ignored", outside));
  return {};
}

}  // namespace popcut::verify
