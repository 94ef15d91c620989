// SPDX-License-Identifier: MIT
#include "core/deploy/unfold_frames.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <unordered_map>

#include <fmt/format.h>

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
      return std::numbers::pi - std::abs(frame.fold_angles_deg[e]) * std::numbers::pi / 180;
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
    return fail(ErrorKind::Malformed, "/vertices_coords",
                "no frame lies flat; the flat sheet is needed as well");
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

/// Compares what the law of parallel panels says with every frame whose angle is known.
Result<void> check_frames(const FoldFile& file, const Sources& sources, const Pattern& pattern,
                          double mm, double within) {
  const auto off = [&](std::size_t i, const std::array<double, 3>& due,
                       const std::array<double, 3>& is, const std::string& where) -> Result<void> {
    const double far = std::hypot(due[0] - mm * is[0], due[1] - mm * is[1], due[2] - mm * is[2]);
    if (far <= within) return {};
    return fail(ErrorKind::OutOfRange, fmt::format("vertex {}", i),
                fmt::format("lies {:.3g} mm off {}, if all panels are parallel to wall or ground; "
                            "other patterns cannot be deployed from their file yet",
                            far, where));
  };
  for (const FoldFrame& frame : file.frames) {
    const auto psi = angle_of(frame);
    const bool flat = &frame == sources.flat;
    if (!flat && (!psi || frame.vertices.size() != pattern.vertices.size())) continue;
    for (std::size_t i = 0; i < frame.vertices.size(); ++i) {
      const PatternVertex& p = pattern.vertices[i];
      auto ok = flat ? off(i, {pattern.u(p), p.v, 0}, frame.vertices[i], "its place on the sheet")
                     : off(i, posed(p, *psi), frame.vertices[i],
                           fmt::format("its place at psi = {} rad", *psi));
      if (!ok) return ok;
    }
  }
  return {};
}

EdgeRole role_of(char assignment) {
  if (assignment == 'M') return EdgeRole::Mountain;
  return assignment == 'V' ? EdgeRole::Valley : EdgeRole::Outline;
}

void add_faces_and_edges(const FoldFrame& flat, Pattern& pattern) {
  std::unordered_map<std::uint64_t, std::int32_t> face_of;  // by directed side
  const auto side = [](std::uint32_t from, std::uint32_t to) {
    return (static_cast<std::uint64_t>(from) << 32) | to;
  };
  pattern.face_first.push_back(0);
  for (const auto& face : flat.faces) {
    for (std::size_t i = 0; i < face.size(); ++i)
      face_of[side(face[i], face[(i + 1) % face.size()])] =
          static_cast<std::int32_t>(pattern.faces());
    pattern.face_vertices.insert(pattern.face_vertices.end(), face.begin(), face.end());
    pattern.face_first.push_back(static_cast<std::uint32_t>(pattern.face_vertices.size()));
  }
  for (std::size_t e = 0; e < flat.edges.size(); ++e) {
    const auto& [from, to] = flat.edges[e];
    const auto left = face_of.find(side(from, to)), right = face_of.find(side(to, from));
    pattern.edges.push_back({from, to, left == face_of.end() ? -1 : left->second,
                             right == face_of.end() ? -1 : right->second,
                             role_of(flat.assignments[e])});
  }
}

}  // namespace

Result<Pattern> pattern_from_fold(const FoldFile& file) {
  const auto sources = sources_of(file);
  if (!sources) return tl::unexpected(sources.error());
  const FoldFrame& flat = *sources->flat;
  const double mm = fold_unit_mm(flat.unit);
  if (mm == 0)
    return fail(ErrorKind::Malformed, "/frame_unit", "is no unit of length that is known; mm is");
  double size = 1e-9;
  auto vertices = designed_places(*sources, mm, size);
  if (!vertices) return tl::unexpected(vertices.error());
  Pattern pattern;
  pattern.name = file.title;
  pattern.vertices = std::move(*vertices);
  double ahead = 0;  // the sheet's u is measured from its edge: H is what it is ahead of x - z
  for (std::size_t i = 0; i < pattern.vertices.size(); ++i)
    ahead += mm * flat.vertices[i][0] - pattern.u(pattern.vertices[i]);
  pattern.wall_mm = ahead / static_cast<double>(pattern.vertices.size());
  for (const PatternVertex& p : pattern.vertices) {
    pattern.width_mm = std::max(pattern.width_mm, p.v);
    pattern.ground_mm = std::max(pattern.ground_mm, pattern.u(p) - pattern.wall_mm);
  }
  if (auto sound = check_frames(file, *sources, pattern, mm, kWithin * size); !sound)
    return tl::unexpected(sound.error());
  add_faces_and_edges(flat, pattern);
  return pattern;
}

}  // namespace popcut
