// SPDX-License-Identifier: MIT
#include "core/judge/pattern_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>

namespace popcut::judge {
namespace {

using verify::Assignment;

/// By `EdgeRole`: in split form both sides of a slit are borders.
constexpr std::array kAssignments{Assignment::Mountain, Assignment::Valley, Assignment::Border,
                                  Assignment::Border};

Result<void> check(const Pattern& pattern) {
  for (std::size_t i = 0; i < pattern.vertices.size(); ++i) {
    const PatternVertex& p = pattern.vertices[i];
    const double size = std::max(std::abs(pattern.u(p)), std::abs(p.v));
    if (!std::isfinite(p.x + p.z + p.v + pattern.wall_mm))
      return fail(ErrorKind::Internal, fmt::format("vertices/{}", i), "is not finite");
    if (!(size <= verify::kMaxCoordinate_mm))
      return fail(ErrorKind::OutOfRange, fmt::format("/vertices_coords/{}", i),
                  fmt::format("{} mm is not within {} mm", size, verify::kMaxCoordinate_mm));
  }
  for (std::size_t e = 0; e < pattern.edges.size(); ++e)
    if (pattern.edges[e].from == pattern.edges[e].to)
      return fail(ErrorKind::OutOfRange, fmt::format("/edges_vertices/{}", e),
                  fmt::format("the edge joins vertex {} to itself", pattern.edges[e].from));
  for (std::size_t f = 0; f < pattern.faces(); ++f) {
    const auto face = pattern.face(f);
    bool sound = face.size() >= 3;
    for (std::size_t k = 0; sound && k < face.size(); ++k)
      sound = face[k] != face[(k + 1) % face.size()];
    if (!sound)
      return fail(ErrorKind::OutOfRange, fmt::format("/faces_vertices/{}", f),
                  "the face has a vertex twice in a row, or less than three");
  }
  return {};
}

}  // namespace

Result<verify::FoldModel> pattern_model(const Pattern& pattern, std::span<const double> psi_rad) {
  if (auto sound = check(pattern); !sound) return tl::unexpected(sound.error());
  verify::FoldModel out;
  out.flat.reserve(pattern.vertices.size());
  for (const PatternVertex& p : pattern.vertices) out.flat.emplace_back(pattern.u(p), p.v);
  out.edges.reserve(pattern.edges.size());
  out.assignment.reserve(pattern.edges.size());
  for (const PatternEdge& edge : pattern.edges) {
    out.edges.push_back({edge.from, edge.to});
    out.assignment.push_back(kAssignments.at(static_cast<std::size_t>(edge.role)));
  }
  out.assigned = out.from_popcut = true;
  out.fold_angle_deg = fold_angles_deg(pattern, std::numbers::pi / 2);
  out.face_first = pattern.face_first;
  out.face_vertices = pattern.face_vertices;
  for (std::size_t k = 0; k < psi_rad.size(); ++k) {
    verify::Pose pose;
    pose.place = fmt::format("/file_frames/{}", k);
    pose.at.reserve(pattern.vertices.size());
    for (const auto& [x, v, z] : posed_vertices(pattern, psi_rad[k])) pose.at.emplace_back(x, v, z);
    pose.fold_angle_deg = fold_angles_deg(pattern, psi_rad[k]);
    pose.psi_rad = psi_rad[k];
    out.poses.push_back(std::move(pose));
  }
  return out;
}

}  // namespace popcut::judge
