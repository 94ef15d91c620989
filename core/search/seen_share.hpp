// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <vector>

#include "core/geometry/vec.hpp"
#include "core/model/triangle_mesh.hpp"

namespace popcut {

/// The share of a mesh's area, 0 to 1, that is seen from at least one of the directions, without
/// perspective. 4096 points of the surface against depths of 256 x 256 pixels.
///
/// @param toward  from the mesh to each eye
[[nodiscard]] double seen_share(const TriangleMesh& mesh, std::span<const Vec3> toward);

/// The directions from which the cards of a book are seen along their diagonals. Card 1 begins at
/// axis `from` (0 to 2), and its wall stands toward axis `to`.
[[nodiscard]] std::vector<Vec3> diagonals_of_book(int cards, int from = 0, int to = 2);

/// What a book of `cards` around one spine could show of a mesh at best: the share of its area that
/// is seen along the diagonal of some card, for the best of the three axes as its spine.
[[nodiscard]] double share_of_book(const TriangleMesh& mesh, int cards);

}  // namespace popcut
