// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <vector>

#include "core/model/triangle_mesh.hpp"
#include "core/search/standing.hpp"

namespace popcut {

/// The turns of a model in which a book is tried: `up`, or each axis of the model where that is
/// none, along the spine, and turned about it by no, a quarter, a half and three quarters of a
/// card's angle.
[[nodiscard]] std::vector<std::array<double, 3>> turns_in_book(const UpSide& up, int cards);

/// The way of a turn in a book, the middle of its box on the spine. `shut_reach` is what a card
/// needs for the point that is farthest from the spine, wherever it lies between its pages: at most
/// r / cos(pi / cards), in its middle. `misfit` is not judged. O(triangles).
///
/// @param cards  at least 3
[[nodiscard]] Way way_in_book(const TriangleMesh& model, const std::array<double, 3>& rotate_deg,
                              int cards);

/// How badly a way suits a book, 0 to 1: the share of the surface that is seen along no card's
/// diagonal.
[[nodiscard]] double misfit_in_book(const TriangleMesh& model, const Way& way, int cards);

/// The model as it stands about the spine, nine numbers a triangle (x, v, z), 100 mm large: the
/// middle of its box at x = z = 0, its least v at 0.
[[nodiscard]] std::vector<float> standing_in_book(const TriangleMesh& model, const Way& way);

}  // namespace popcut
