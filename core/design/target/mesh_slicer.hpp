// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "core/design/target/section.hpp"
#include "core/model/triangle_mesh.hpp"

namespace popcut {

/// Triangles in the corner (x from the wall, y along the spine, z up, mm), ready to be cut by
/// planes y = s. Built in O(T log T) by sorting them by their smallest y, with a tree of the
/// largest y over that order; a plane costs O(k log T) for the k triangles that it meets.
class MeshSlicer {
 public:
  explicit MeshSlicer(TriangleMesh mesh);

  /// The mesh's extent along the spine.
  [[nodiscard]] double low_mm() const { return low_; }
  [[nodiscard]] double high_mm() const { return high_; }
  [[nodiscard]] const MeshBox& box() const { return box_; }
  [[nodiscard]] const TriangleMesh& mesh() const { return mesh_; }

  /// The boundary in the plane y = s. A corner of a triangle that lies in the plane counts as above
  /// it, so that closed meshes have closed sections; the mesh's own first and last plane are cut a
  /// billionth of its length inside. Ends that no other piece continues are `open_ends`.
  [[nodiscard]] Section cut(double s_mm) const;

 private:
  static constexpr std::size_t kBranch = 64;
  void collect(std::size_t level, std::size_t node, std::size_t begun, double s,
               std::vector<std::uint32_t>& out) const;
  [[nodiscard]] float coordinate(std::size_t triangle, std::size_t corner, std::size_t axis) const {
    return mesh_.corners[9 * triangle + 3 * corner + axis];
  }
  [[nodiscard]] SectionPoint crossing(std::size_t triangle, std::size_t below, std::size_t above,
                                      double s) const;

  TriangleMesh mesh_;
  MeshBox box_;
  double low_{}, high_{};
  std::vector<std::uint32_t> order_;         ///< by the smallest y
  std::vector<float> smallest_;              ///< in that order
  std::vector<std::vector<float>> largest_;  ///< of each triangle, each 64, each 4096, ...
};

}  // namespace popcut
