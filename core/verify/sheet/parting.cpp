// SPDX-License-Identifier: MIT
#include "core/verify/sheet/parting.hpp"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "core/geometry/disjoint_sets.hpp"

namespace popcut::verify {
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

}  // namespace popcut::verify
