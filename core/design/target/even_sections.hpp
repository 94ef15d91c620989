// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <vector>

#include "core/design/target/section.hpp"
#include "core/model/triangle_mesh.hpp"

namespace popcut {

/// Planes y = first_mm + k step_mm, for k from 0 to count - 1.
struct EvenPlanes {
  double first_mm{}, step_mm{};
  int count{};
};

/// The boundaries of a mesh, moved by `shift_mm`, in evenly spaced planes: those of
/// `MeshSlicer::cut` without their open ends and without its care for the mesh's own first and last
/// plane. For a mesh that is cut once: one pass over the triangles, no sorting. O(triangles +
/// pieces).
[[nodiscard]] std::vector<Section> even_sections(const TriangleMesh& mesh,
                                                 const std::array<double, 3>& shift_mm,
                                                 const EvenPlanes& planes);

}  // namespace popcut
