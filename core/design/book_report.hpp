// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "core/fit/fit_figures.hpp"

namespace popcut {

/// Two faces that are glued back to back: the wall of one card and the ground of the next one. They
/// are rectangles of the page's size and coincide at every opening.
struct BookSeam {
  std::size_t wall_of{}, ground_of{};  ///< cards, from 0
};

/// How near all cards together come to the whole target.
struct BookFit {
  static constexpr std::array<double, 3> kWithin{0.015, 0.02, 0.05};
  double size_mm{};  ///< diagonal of the box around the target
  double target_mm2{}, structure_mm2{};
  std::array<double, 3> share_within{};  ///< of the target's area, within `kWithin` of the size
  DistanceFigures to_structure;          ///< of the target's points from the structures
  DistanceFigures to_target;             ///< of the structures' points from the target
};

/// A book as a whole: its cards stand around the spine, card i from `i angle_deg` to
/// `(i + 1) angle_deg`, its ground first.
struct BookReport {
  double angle_deg{};          ///< opening angle of each card when the book is open all around
  double page_mm{};            ///< of each wall and each ground, from the spine outward
  double width_mm{};           ///< along the spine
  double shift_mm{};           ///< places along the sheets less those along the target
  double closed_mm{};          ///< how far the structures reach from the spine when it is shut
  std::vector<bool> is_plain;  ///< one a card: nothing of the target is there, so it is plain
  bool is_alike{};             ///< all cards are the same
  /// One less than cards: the first ground and the last wall are the covers.
  std::vector<BookSeam> seams;
  std::optional<BookFit> fit;  ///< left to `book_fit`, which takes as long as a small design
};

}  // namespace popcut
