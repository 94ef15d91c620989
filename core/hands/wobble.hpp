// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/pattern/pattern.hpp"

namespace popcut::hands {

/// How far a fold made by hand lies off its line.
struct Play {
  double line_mm{0.1};  ///< standard deviation of the whole line, square to it
  double end_mm{0.15};  ///< of each of its ends, beside that
  /// A shorter fold holds less: its variance grows with `short_fold_mm / length`.
  double short_fold_mm{4.0};
};

/// How far the faces of a card move when its folds lie off their lines by `Play`. Wall and ground
/// are fixed.
struct WobbleFigures {
  double largest_mm{};
  double mean_mm{};      ///< over the area of all faces but wall and ground
  std::size_t loose{};   ///< faces above `kFirm_mm`
  double loose_share{};  ///< of that area
};
struct Wobble : WobbleFigures {
  /// One a face: the root mean square of the movement of its farthest point, mm; 0 for wall and
  /// ground.
  std::vector<double> face_mm;
};

/// A face that moves by more does not hold in paper: by more than 1 mm, said to a tenth of it.
inline constexpr double kFirm_mm = 1.05;
/// Patterns with more faces are not measured.
inline constexpr std::size_t kMostWobbleFaces = 20'000;

/// Measures how firmly the faces hold at psi = pi/2 (docs/hands.md, section 1).
///
/// All folds but those of V-folds are parallel to the spine, so a face moves in the section plane:
/// a point (x, z) of it by (a - w z, c + w x). Each fold asks that its two faces agree there, with
/// the variance s^2 = line_mm^2 + end_mm^2 / 2 of its middle. With J for these equations over all
/// faces but wall and ground, the covariance of the movements is s^2 (J^T J)^-1. Only its blocks on
/// the diagonal are needed; they follow from the sparse Cholesky factor alone (Takahashi 1973). The
/// triangles of a V-fold move as much as the looser one of the two panels that they fold on.
///
/// @return none for a pattern of more than `kMostWobbleFaces` faces, or without folds
[[nodiscard]] std::optional<Wobble> wobble_of(const Pattern& pattern, const Play& play = {});

}  // namespace popcut::hands
