// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/model/triangle_mesh.hpp"

namespace popcut {

/// What keeps a mesh from being the surface of a solid.
struct MeshFaults {
  std::size_t open_edges{};  ///< that only one triangle has
  std::size_t crossings{};   ///< pairs of triangles that go through each other
  bool crossings_counted{};  ///< not of more than `kMostCrossed` triangles, which takes long
  double area{};             ///< of all triangles, in units of the mesh squared
};
inline constexpr std::size_t kMostCrossed = 100'000;

/// Looks at a mesh. Corners are the same if their coordinates are. Of triangles that share a corner
/// none counts as crossing. About O(n log n), O(n^2) at worst for crossings.
[[nodiscard]] MeshFaults faults_of(const TriangleMesh& mesh);

/// What that means for a card: a sentence each.
[[nodiscard]] std::vector<std::string> in_words(const MeshFaults& faults);

}  // namespace popcut
