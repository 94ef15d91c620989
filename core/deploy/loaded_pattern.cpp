// SPDX-License-Identifier: MIT
#include "core/deploy/loaded_pattern.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <tuple>
#include <unordered_map>
#include <utility>

#include <fmt/format.h>

#include "core/geometry/angle.hpp"

namespace popcut {
namespace {

constexpr double kWithin = 1e-5;       // of the sheet's size
constexpr double kMostMm = 100'000.0;  // nothing is longer than 100 m

bool is_flat(const FoldFrame& frame) {
  return std::all_of(frame.vertices.begin(), frame.vertices.end(),
                     [](const auto& p) { return p[2] == 0; });
}

/// The opening angle of a frame as its valleys and mountains have it.
std::optional<double> angle_of(const FoldFrame& frame) {
  if (frame.psi_rad) return frame.psi_rad;
  if (!frame.folded_form) return std::nullopt;
  for (std::size_t e = 0; e < frame.edges.size(); ++e) {
    const char role = frame.assignments[e];
    if (role == 'V' || role == 'M')
      return std::numbers::pi - radians(std::abs(frame.fold_angles_deg[e]));
  }
  return std::nullopt;
}

/// The frames that the pattern is found from.
struct Sources {
  const FoldFrame* flat{};
  const FoldFrame* deployed{};
  double psi_rad{};
};

Result<Sources> sources_of(const FoldFile& file) {
  Sources found;
  for (const FoldFrame& frame : file.frames) {
    if (found.flat == nullptr && !frame.folded_form && !frame.vertices.empty() && is_flat(frame))
      found.flat = &frame;
    const auto psi = angle_of(frame);
    if (!psi || !(*psi >= 0 && *psi <= std::numbers::pi) || is_flat(frame)) continue;
    // The closer to a right angle, the better both coordinates are known.
    if (found.deployed == nullptr || std::sin(*psi) > std::sin(found.psi_rad)) {
      found.deployed = &frame;
      found.psi_rad = *psi;
    }
  }
  if (found.flat == nullptr)
    return fail(
        ErrorKind::Malformed, "/vertices_coords",
        "no frame lies flat, and poses start from the flat sheet; export the crease pattern "
        "(frame_classes creasePattern), alone or with the folded form");
  if (found.flat->faces.empty())
    return fail(ErrorKind::Malformed, "/faces_vertices",
                "is missing; the faces of the sheet are needed");
  if (found.deployed == nullptr || std::sin(found.psi_rad) < 1e-3) {
    return fail(ErrorKind::Malformed, "/file_frames",
                "no frame is deployed to a known angle; one with frame_popcut:psi_rad (or fold "
                "angles) between flat and shut is needed");
  }
  if (found.deployed->vertices.size() != found.flat->vertices.size())
    return fail(ErrorKind::Malformed, "/file_frames",
                "the deployed frame has not the flat sheet's number of vertices");
  return found;
}

/// Gives numbers that differ by rounding alone one common value, so that planes are planes again.
void snap(std::vector<PatternVertex>& vertices, double PatternVertex::*part, double within) {
  std::vector<std::uint32_t> order(vertices.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return vertices[a].*part < vertices[b].*part;
  });
  double common = 0, first = -1e300;
  for (const std::uint32_t i : order) {
    double& value = vertices[i].*part;
    if (value - first > within) {
      first = value;
      common = std::abs(value) <= within ? 0 : value;
    }
    value = common;
  }
}

Result<std::vector<PatternVertex>> designed_places(const Sources& sources, double mm,
                                                   double& size) {
  const double c = std::cos(sources.psi_rad), s = std::sin(sources.psi_rad);
  std::vector<PatternVertex> vertices;
  for (std::size_t i = 0; i < sources.deployed->vertices.size(); ++i) {
    const auto& [x, v, z] = sources.deployed->vertices[i];
    if (!(std::abs(mm * x) < kMostMm && std::abs(mm * v) < kMostMm && std::abs(mm * z) < kMostMm))
      return fail(ErrorKind::OutOfRange, fmt::format("vertex {}", i),
                  "lies farther than 100 m from the origin");
    vertices.push_back({mm * (x - z / s * c), mm * z / s, mm * v});
    size = std::max({size, std::abs(mm * x), std::abs(mm * v), std::abs(mm * z)});
  }
  constexpr double kRounding = 1e-7;
  for (double PatternVertex::*part : {&PatternVertex::x, &PatternVertex::z, &PatternVertex::v})
    snap(vertices, part, kRounding * size);
  return vertices;
}

/// Compares what popcut's law of motion says with every frame whose angle is known.
Result<void> check_frames(const FoldFile& file, const Sources& sources, const Pattern& pattern,
                          double mm, double within) {
  const auto compare = [&](const FoldFrame& frame, const std::vector<std::array<double, 3>>& due,
                           const std::string& where) -> Result<void> {
    for (std::size_t i = 0; i < due.size(); ++i) {
      const auto& is = frame.vertices[i];
      const double far =
          std::hypot(due[i][0] - mm * is[0], due[i][1] - mm * is[1], due[i][2] - mm * is[2]);
      if (far <= within) continue;
      return fail(
          ErrorKind::OutOfRange, fmt::format("vertex {}", i),
          fmt::format("lies {:.3g} mm off {}, if panels are parallel to wall or ground, or two "
                      "sloped ones hang between them, and V-folds lie on their creases; other "
                      "patterns cannot be deployed "
                      "from their file yet",
                      far, where));
    }
    return {};
  };
  std::vector<std::array<double, 3>> flat;
  for (const PatternVertex& p : pattern.vertices) flat.push_back({pattern.u(p), p.v, 0});
  if (auto ok = compare(*sources.flat, flat, "its place on the sheet"); !ok) return ok;
  for (const FoldFrame& frame : file.frames) {
    const auto psi = angle_of(frame);
    if (&frame == sources.flat || !psi || frame.vertices.size() != flat.size()) continue;
    auto ok = compare(frame, posed_vertices(pattern, *psi),
                      fmt::format("its place at psi = {} rad", *psi));
    if (!ok) return ok;
  }
  return {};
}

std::uint64_t side(std::uint32_t from, std::uint32_t to) {
  return (static_cast<std::uint64_t>(from) << 32) | to;
}

EdgeRole role_of(char assignment) {
  if (assignment == 'M') return EdgeRole::Mountain;
  return assignment == 'V' ? EdgeRole::Valley : EdgeRole::Outline;
}

/// H: what the flat frame's u is ahead of x - z. The middle of all, since tips of V-folds differ.
double height_of_wall(const FoldFrame& flat, const Pattern& pattern, double mm) {
  std::vector<double> ahead;
  for (std::size_t i = 0; i < pattern.vertices.size(); ++i)
    ahead.push_back(mm * flat.vertices[i][0] - (pattern.vertices[i].x - pattern.vertices[i].z));
  const auto middle = ahead.begin() + static_cast<std::ptrdiff_t>(ahead.size() / 2);
  std::nth_element(ahead.begin(), middle, ahead.end());
  return *middle;
}

/// Finds V-folds and puts their tips back on the crease: pairs of triangles, apex - tip - B and
/// apex - C - tip, whose tip is not where a point of a panel would be.
class TipFinder {
 public:
  TipFinder(const FoldFrame& flat, double mm, double within, Pattern& pattern)
      : flat_(flat), mm_(mm), within_(within), pattern_(pattern) {
    for (std::uint32_t e = 0; e < pattern.edges.size(); ++e)
      edge_of_[side(pattern.edges[e].from, pattern.edges[e].to)] = e;
  }

  void run() {
    std::map<std::uint32_t, std::vector<std::size_t>> triangles_at;
    for (std::size_t f = 0; f < pattern_.faces(); ++f) {
      const auto face = pattern_.face(f);
      if (face.size() != 3) continue;
      for (const std::uint32_t i : face)
        if (has_left(i)) triangles_at[i].push_back(f);
    }
    for (const auto& [tip, triangles] : triangles_at)
      if (triangles.size() == 2) add(tip, triangles);
  }

 private:
  [[nodiscard]] bool has_left(std::uint32_t i) const {
    const PatternVertex& p = pattern_.vertices[i];
    return std::abs(pattern_.u(p) - mm_ * flat_.vertices[i][0]) > within_ ||
           std::abs(p.v - mm_ * flat_.vertices[i][1]) > within_;
  }

  void add(std::uint32_t tip, const std::vector<std::size_t>& triangles) {
    for (const std::size_t first : {triangles[0], triangles[1]}) {
      const std::size_t second = first == triangles[0] ? triangles[1] : triangles[0];
      const auto [b, o] = around(first, tip);       // o, tip, b
      const auto [other, c] = around(second, tip);  // o, c, tip
      if (o != other) continue;
      const auto edge_b = outgoing(o, b), edge_c = outgoing(o, c);
      if (!edge_b || !edge_c) continue;
      const double length = mm_ * std::abs(flat_.vertices[tip][1] - flat_.vertices[o][1]);
      const double reach = mm_ * std::abs(flat_.vertices[b][0] - flat_.vertices[o][0]);
      if (!(length > 0)) return;
      const PatternVertex& apex = pattern_.vertices[o];
      pattern_.vertices[tip] = {apex.x, apex.z, mm_ * flat_.vertices[tip][1]};
      pattern_.v_folds.push_back({o, tip, *edge_b, *edge_c, length, reach / length});
      return;
    }
  }

  /// The corners after and before `tip` in a triangle.
  [[nodiscard]] std::pair<std::uint32_t, std::uint32_t> around(std::size_t f,
                                                               std::uint32_t tip) const {
    const auto face = pattern_.face(f);
    const auto at =
        static_cast<std::size_t>(std::find(face.begin(), face.end(), tip) - face.begin());
    return {face[(at + 1) % 3], face[(at + 2) % 3]};
  }

  /// The edge from `o` to `to`, turned to run that way.
  std::optional<std::uint32_t> outgoing(std::uint32_t o, std::uint32_t to) {
    if (const auto found = edge_of_.find(side(o, to)); found != edge_of_.end())
      return found->second;
    const auto found = edge_of_.find(side(to, o));
    if (found == edge_of_.end()) return std::nullopt;
    PatternEdge& edge = pattern_.edges[found->second];
    std::swap(edge.from, edge.to);
    std::swap(edge.left, edge.right);
    return found->second;
  }

  const FoldFrame& flat_;
  double mm_, within_;
  Pattern& pattern_;
  std::unordered_map<std::uint64_t, std::uint32_t> edge_of_;
};

/// Finds kites: two panels, parallel to neither wall nor ground, that meet in a fold and hang on a
/// fold each. Puts their points where those of the stair are that is the same paper.
class KiteFinder {
 public:
  KiteFinder(const FoldFrame& flat, double mm, Pattern& pattern)
      : flat_(flat), mm_(mm), pattern_(pattern) {}

  void run() {
    for (const PatternEdge& edge : pattern_.edges)
      if (edge.left >= 0 && edge.right >= 0 && edge.left != edge.right && is_sloped(edge.left) &&
          is_sloped(edge.right))
        add(static_cast<std::uint32_t>(edge.left), static_cast<std::uint32_t>(edge.right));
    for (const Kite& kite : pattern_.kites)
      for (const std::uint32_t i : kite.vertices) put_back(kite.section, i);
  }

 private:
  [[nodiscard]] bool is_sloped(std::int32_t face) const {
    const auto corners = pattern_.face(static_cast<std::size_t>(face));
    const auto differ = [&](double PatternVertex::*part) {
      return std::any_of(corners.begin(), corners.end(), [&](std::uint32_t corner) {
        return pattern_.vertices[corner].*part != pattern_.vertices[corners.front()].*part;
      });
    };
    return differ(&PatternVertex::x) && differ(&PatternVertex::z);
  }
  [[nodiscard]] double u_mm(std::uint32_t vertex) const { return mm_ * flat_.vertices[vertex][0]; }
  [[nodiscard]] double v_mm(std::uint32_t vertex) const { return mm_ * flat_.vertices[vertex][1]; }

  /// The fold of a face, to another one than `beside`, that is nearest to the wall's top or
  /// farthest from it.
  [[nodiscard]] std::vector<std::uint32_t> outer_folds(std::uint32_t face,
                                                       std::uint32_t beside) const {
    std::vector<std::uint32_t> out;
    for (std::uint32_t e = 0; e < pattern_.edges.size(); ++e) {
      const PatternEdge& edge = pattern_.edges[e];
      const auto left = static_cast<std::uint32_t>(edge.left),
                 right = static_cast<std::uint32_t>(edge.right);
      if (edge.left < 0 || edge.right < 0 || left == right) continue;
      if ((left == face && right != beside) || (right == face && left != beside)) out.push_back(e);
    }
    return out;
  }

  void add(std::uint32_t a, std::uint32_t b) {
    for (const Kite& kite : pattern_.kites)
      if (kite.faces[0] == a || kite.faces[1] == a) return;
    std::vector<std::uint32_t> upper = outer_folds(a, b), lower = outer_folds(b, a);
    if (upper.empty() || lower.empty()) return;
    if (u_mm(pattern_.edges[upper[0]].from) > u_mm(pattern_.edges[lower[0]].from))
      std::swap(a, b), std::swap(upper, lower);
    const PatternVertex &q = pattern_.vertices[pattern_.edges[upper[0]].from],
                        &e = pattern_.vertices[pattern_.edges[lower[0]].from];
    Kite kite;
    kite.section = {{q.x, q.z}, {e.x, e.z}};
    if (!(kite.section.p_mm() > 0.0) || !(kite.section.q_mm() > 0.0)) return;
    kite.faces = {a, b};
    kite.edges = upper;
    kite.edges.insert(kite.edges.end(), lower.begin(), lower.end());
    const double first = u_mm(pattern_.edges[upper[0]].from),
                 last = u_mm(pattern_.edges[lower[0]].from);
    const double within = kWithin * (last - first);
    kite.v0_mm = v_mm(pattern_.edges[upper[0]].from), kite.v1_mm = kite.v0_mm;
    for (const std::uint32_t face : kite.faces)
      for (const std::uint32_t i : pattern_.face(face)) {
        kite.v0_mm = std::min(kite.v0_mm, v_mm(i)), kite.v1_mm = std::max(kite.v1_mm, v_mm(i));
        if (u_mm(i) > first + within && u_mm(i) < last - within) kite.vertices.push_back(i);
      }
    std::sort(kite.vertices.begin(), kite.vertices.end());
    kite.vertices.erase(std::unique(kite.vertices.begin(), kite.vertices.end()),
                        kite.vertices.end());
    pattern_.kites.push_back(std::move(kite));
  }

  void put_back(const KiteSection& kite, std::uint32_t i) {
    const double from_q = u_mm(i) - pattern_.wall_mm - (kite.q.x - kite.q.z);
    const double down = std::min(from_q, kite.q_mm());
    pattern_.vertices[i].x = kite.q.x + (from_q - down);
    pattern_.vertices[i].z = kite.q.z - down;
  }

  const FoldFrame& flat_;
  double mm_;
  Pattern& pattern_;
};

/// An end of a panel's line, with the strip it is in. Ends meet when they are equal to the digit,
/// as they are in files that are written from one number.
using End = std::tuple<double, double, double, double>;  // v, width, x, z

bool is_level(const SegmentPanel& panel) {
  return std::abs(panel.x1 - panel.x0) > std::abs(panel.z1 - panel.z0);
}

}  // namespace

void add_faces_and_edges(const FoldFrame& flat, Pattern& pattern) {
  std::unordered_map<std::uint64_t, std::int32_t> face_of;  // by directed side
  pattern.face_first.push_back(0);
  for (const auto& face : flat.faces) {
    for (std::size_t i = 0; i < face.size(); ++i)
      face_of[side(face[i], face[(i + 1) % face.size()])] =
          static_cast<std::int32_t>(pattern.faces());
    pattern.face_vertices.insert(pattern.face_vertices.end(), face.begin(), face.end());
    pattern.face_first.push_back(static_cast<std::uint32_t>(pattern.face_vertices.size()));
  }
  const auto beside = [&](std::uint32_t from, std::uint32_t to) {
    const auto found = face_of.find(side(from, to));
    return found == face_of.end() ? -1 : found->second;
  };
  for (std::size_t e = 0; e < flat.edges.size(); ++e) {
    const auto& [from, to] = flat.edges[e];
    pattern.edges.push_back(
        {from, to, beside(from, to), beside(to, from), role_of(flat.assignments[e])});
  }
}

Result<Pattern> pattern_from_fold(const FoldFile& file) {
  const auto sources = sources_of(file);
  if (!sources) return tl::unexpected(sources.error());
  const FoldFrame& flat = *sources->flat;
  const double mm = fold_unit_mm(flat.unit);
  if (mm == 0)
    return fail(ErrorKind::Malformed, "/frame_unit", "is not a known unit of length; use mm");
  double size = 1e-9;
  auto vertices = designed_places(*sources, mm, size);
  if (!vertices) return tl::unexpected(vertices.error());
  Pattern pattern;
  pattern.name = file.title;
  if (const double psi = file.design_psi_rad.value_or(0.0); psi > 0.0 && psi < std::numbers::pi)
    pattern.design_psi_rad = psi;
  pattern.vertices = std::move(*vertices);
  pattern.wall_mm = height_of_wall(flat, pattern, mm);
  add_faces_and_edges(flat, pattern);
  TipFinder(flat, mm, kWithin * size, pattern).run();
  KiteFinder(flat, mm, pattern).run();
  for (const PatternVertex& p : pattern.vertices) {
    pattern.width_mm = std::max(pattern.width_mm, p.v);
    pattern.ground_mm = std::max(pattern.ground_mm, pattern.u(p) - pattern.wall_mm);
  }
  if (auto sound = check_frames(file, *sources, pattern, mm, kWithin * size); !sound)
    return tl::unexpected(sound.error());
  return pattern;
}

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
