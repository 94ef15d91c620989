// SPDX-License-Identifier: MIT
#include "core/drawing/planar_graph.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <unordered_map>

#include "core/drawing/linework.hpp"
#include "core/geometry/disjoint_sets.hpp"
#include "core/geometry/node_index.hpp"
#include "core/geometry/segment_grid.hpp"

namespace popcut {
namespace {

constexpr std::size_t kMostCrossings = 20'000'000;

/// A vertex on a line, by its place along it.
struct Stop {
  std::uint32_t line{};
  double t{};
  std::uint32_t vertex{};
};

double along(const Segment& s, const PagePoint& p) {
  const double dx = s.b.x - s.a.x, dy = s.b.y - s.a.y;
  return ((p.x - s.a.x) * dx + (p.y - s.a.y) * dy) / (dx * dx + dy * dy);
}

int strength(char assignment) {
  constexpr std::string_view kOrder = "FUVMBC";
  const std::size_t place = kOrder.find(assignment);
  return place == std::string_view::npos ? 1 : static_cast<int>(place);
}

/// Finds the places where lines stop each other.
class Crossings {
 public:
  Crossings(const std::vector<Segment>& lines, double tolerance, NodeIndex& nodes)
      : lines_(lines), tolerance_(tolerance), nodes_(nodes) {
    for (const Segment& line : lines) ends_.push_back({node_at(line.a), node_at(line.b)});
  }

  bool find() {
    SegmentGrid grid(lines_, tolerance_);
    std::vector<std::uint32_t> near;
    for (std::uint32_t i = 0; i < lines_.size(); ++i) {
      stops.push_back({i, 0.0, ends_[i][0]});
      stops.push_back({i, 1.0, ends_[i][1]});
      grid.near(lines_[i], near);
      for (const std::uint32_t j : near) {
        if (j == i) continue;
        for (const std::uint32_t end : ends_[j]) end_on(i, end);
        if (j > i) cross(i, j);
      }
      if (stops.size() > kMostCrossings) return false;
    }
    return true;
  }

  std::vector<Stop> stops;

 private:
  std::uint32_t node_at(const PagePoint& p) { return nodes_.find_or_add(p, tolerance_); }

  void end_on(std::uint32_t i, std::uint32_t vertex) {
    if (vertex == ends_[i][0] || vertex == ends_[i][1]) return;
    const PagePoint& p = nodes_.point(vertex);
    const double t = along(lines_[i], p);
    if (t > 0.0 && t < 1.0 && distance(lerp(lines_[i].a, lines_[i].b, t), p) <= tolerance_)
      stops.push_back({i, t, vertex});
  }

  void cross(std::uint32_t i, std::uint32_t j) {
    const Segment &p = lines_[i], &q = lines_[j];
    const PagePoint d{p.b.x - p.a.x, p.b.y - p.a.y}, e{q.b.x - q.a.x, q.b.y - q.a.y};
    const double turn = d.x * e.y - d.y * e.x;
    const double size = std::hypot(d.x, d.y) * std::hypot(e.x, e.y);
    if (!(std::abs(turn) > 1e-9 * size)) return;
    const PagePoint o{q.a.x - p.a.x, q.a.y - p.a.y};
    const double s = (o.x * e.y - o.y * e.x) / turn, t = (o.x * d.y - o.y * d.x) / turn;
    if (!(s > 0.0 && s < 1.0 && t > 0.0 && t < 1.0)) return;
    const std::uint32_t vertex = node_at(lerp(p.a, p.b, s));
    stops.push_back({i, s, vertex});
    stops.push_back({j, t, vertex});
  }

  const std::vector<Segment>& lines_;
  double tolerance_;
  NodeIndex& nodes_;
  std::vector<std::array<std::uint32_t, 2>> ends_;
};

/// Adds edges between the stops of each line, each pair of vertices once.
void add_edges(std::vector<Stop>& stops, std::span<const CreaseLine> lines,
               std::span<const std::uint32_t> line_of, PlanarGraph& graph) {
  std::sort(stops.begin(), stops.end(), [](const Stop& a, const Stop& b) {
    return a.line != b.line ? a.line < b.line : a.t < b.t;
  });
  std::unordered_map<std::uint64_t, std::uint32_t> known;
  for (std::size_t i = 1; i < stops.size(); ++i) {
    const auto [low, high] = std::minmax(stops[i - 1].vertex, stops[i].vertex);
    if (stops[i].line != stops[i - 1].line || low == high) continue;
    const auto number = static_cast<std::uint32_t>(graph.edges.size());
    const auto [found, is_new] =
        known.try_emplace(std::uint64_t{low} << 32 | std::uint64_t{high}, number);
    const std::uint32_t line = line_of[stops[i].line];
    const char letter = lines[line].assignment;
    if (is_new) {
      graph.edges.push_back({low, high});
      graph.assignments.push_back(letter);
      graph.lines.push_back(line);
    } else if (strength(letter) > strength(graph.assignments[found->second])) {
      graph.assignments[found->second] = letter;
      graph.lines[found->second] = line;
    }
  }
}

/// Half edges: 2 e goes from the first to the second vertex of edge e, 2 e + 1 back.
std::uint32_t tail(const PlanarGraph& graph, std::uint32_t half) {
  return graph.edges[half / 2].at(half % 2);
}

/// For each half edge, the next one of the face to its left.
std::vector<std::uint32_t> next_halves(const PlanarGraph& graph) {
  const auto halves = static_cast<std::uint32_t>(2 * graph.edges.size());
  std::vector<double> angle(halves);
  std::vector<std::uint32_t> order(halves), next(halves);
  for (std::uint32_t h = 0; h < halves; ++h) {
    const PagePoint &a = graph.vertices[tail(graph, h)], &b = graph.vertices[tail(graph, h ^ 1U)];
    angle[h] = std::atan2(b.y - a.y, b.x - a.x);
  }
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](std::uint32_t g, std::uint32_t h) {
    const std::uint32_t a = tail(graph, g), b = tail(graph, h);
    return a != b ? a < b : angle[g] != angle[h] ? angle[g] < angle[h] : g < h;
  });
  for (std::size_t begin = 0; begin < order.size();) {
    std::size_t end = begin;
    while (end < order.size() && tail(graph, order[end]) == tail(graph, order[begin])) ++end;
    // When the walk arrives at a vertex, the face to the left continues with the previous half edge
    // there.
    for (std::size_t i = begin; i < end; ++i)
      next[order[i] ^ 1U] = order[i == begin ? end - 1 : i - 1];
    begin = end;
  }
  return next;
}

void trace_faces(PlanarGraph& graph) {
  const std::vector<std::uint32_t> next = next_halves(graph);
  std::vector<std::uint8_t> done(next.size());
  graph.edge_faces.assign(graph.edges.size(), {-1, -1});
  std::vector<std::uint32_t> loop;
  for (std::uint32_t start = 0; start < next.size(); ++start) {
    if (done[start] != 0) continue;
    loop.clear();
    double area = 0.0;
    const PagePoint& o = graph.vertices[tail(graph, start)];
    for (std::uint32_t h = start; done[h] == 0; h = next[h]) {
      done[h] = 1;
      loop.push_back(h);
      const PagePoint &a = graph.vertices[tail(graph, h)], &b = graph.vertices[tail(graph, h ^ 1U)];
      area += (a.x - o.x) * (b.y - o.y) - (b.x - o.x) * (a.y - o.y);
    }
    if (!(area > 0.0)) continue;
    const auto face = static_cast<std::int32_t>(graph.faces.size());
    graph.faces.emplace_back();
    for (const std::uint32_t h : loop) {
      graph.faces.back().push_back(tail(graph, h));
      graph.edge_faces[h / 2].at(h % 2) = face;
    }
  }
}

bool opens(char assignment) { return assignment == 'C' || assignment == 'B'; }

}  // namespace

std::size_t PlanarGraph::joined(std::string_view over) const {
  DisjointSets sets(faces.size());
  std::size_t count = faces.size();
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const auto [left, right] = edge_faces[e];
    if (left < 0 || right < 0 || over.find(assignments[e]) == std::string_view::npos) continue;
    if (sets.join(static_cast<std::uint32_t>(left), static_cast<std::uint32_t>(right))) --count;
  }
  return count;
}

Result<PlanarGraph> planar_graph(std::span<const CreaseLine> lines, double tolerance) {
  std::vector<Segment> segments;
  std::vector<std::uint32_t> line_of;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const Segment& s = lines[i].segment;
    for (const PagePoint& p : {s.a, s.b})
      if (!(std::abs(p.x) <= kMaxCoordinate && std::abs(p.y) <= kMaxCoordinate))
        return fail(ErrorKind::OutOfRange, "",
                    "a line lies more than 100 m from the origin; move it closer");
    if (distance(s.a, s.b) <= tolerance) continue;
    segments.push_back(s);
    line_of.push_back(static_cast<std::uint32_t>(i));
  }
  PlanarGraph graph;
  if (segments.empty()) return graph;
  NodeIndex nodes(std::max(tolerance, 1e-9), 2 * segments.size());
  Crossings crossings(segments, tolerance, nodes);
  if (!crossings.find())
    return fail(ErrorKind::OutOfRange, "", "the lines cross too often; is this a crease pattern?");
  graph.vertices = std::move(nodes).take_points();
  add_edges(crossings.stops, lines, line_of, graph);
  trace_faces(graph);
  return graph;
}

PlanarGraph split_cuts(const PlanarGraph& graph) {
  // 1. A corner of a face is its half edge that leaves the vertex. Two corners at a vertex belong
  // to one fan if the edge between them is not cut.
  std::vector<std::uint32_t> next = next_halves(graph);
  DisjointSets fans(next.size());
  for (std::uint32_t h = 0; h < next.size(); ++h) {
    const bool inside = graph.edge_faces[h / 2][0] >= 0 && graph.edge_faces[h / 2][1] >= 0;
    // The corner of h at its tail, and the corner of the face on the other side: next of its twin.
    if (inside && !opens(graph.assignments[h / 2])) fans.join(h, next[h ^ 1U]);
  }
  // 2. One vertex per fan that has a face.
  PlanarGraph out;
  constexpr std::uint32_t kNone = ~std::uint32_t{0};
  std::vector<std::uint32_t> vertex(next.size(), kNone);
  const auto vertex_of = [&](std::uint32_t h) {
    std::uint32_t& v = vertex[fans.find(h)];
    if (v == kNone) {
      v = static_cast<std::uint32_t>(out.vertices.size());
      out.vertices.push_back(graph.vertices[tail(graph, h)]);
    }
    return v;
  };
  // 3. Edges: a cut gives one per side, others one. The end of h is the tail of the next half edge.
  out.faces.resize(graph.faces.size());
  for (std::uint32_t e = 0; e < graph.edges.size(); ++e) {
    const bool open = opens(graph.assignments[e]);
    for (std::uint32_t side = 0; side < 2; ++side) {
      const std::int32_t face = graph.edge_faces[e].at(side);
      const std::uint32_t h = 2 * e + side;
      if (face < 0 || (!open && side == 1 && graph.edge_faces[e][0] >= 0)) continue;
      out.edges.push_back({vertex_of(h), vertex_of(next[h])});
      out.assignments.push_back(open ? 'B' : graph.assignments[e]);
      out.lines.push_back(graph.lines[e]);
      out.edge_faces.push_back({face, open ? -1 : graph.edge_faces[e].at(1 - side)});
    }
  }
  // 4. Faces, along the same half edges.
  std::vector<std::uint8_t> done(next.size());
  for (std::uint32_t start = 0; start < next.size(); ++start) {
    const std::int32_t face = graph.edge_faces[start / 2].at(start % 2);
    if (face < 0 || done[start] != 0) continue;
    for (std::uint32_t h = start; done[h] == 0; h = next[h]) {
      done[h] = 1;
      out.faces[static_cast<std::size_t>(face)].push_back(vertex_of(h));
    }
  }
  return out;
}

}  // namespace popcut
