// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/design/slices/flat_shape.hpp"

namespace popcut {

/// Slices of one family are parallel. Those of `X` lie in planes x = c with (u, v) = (y, z), those
/// of `Y` in planes y = d with (x, z). Both cross along lines in the direction z.
enum class SliceFamily : std::uint8_t { X, Y };

/// A slice before slots are cut in it.
struct Slice {
  SliceFamily family{};
  double at_mm{};
  bool is_foot{};     ///< x = 0 or y = 0: it is glued to a page
  FlatRings ground;   ///< the paper that is joined to the strip at its foot; may be none
  FlatRings islands;  ///< the rest, each piece of it an island
};

struct SlotSize {
  double width_mm{};
  double overlap_mm{0.1};  ///< by which each slot goes beyond the middle of what it shares
  double least_mm{4.0};    ///< shorter crossings hold nothing
};

/// A piece of paper of a slice.
struct SlicePiece {
  std::size_t slice{};
  FlatRings paper;  ///< outline and holes
  /// In the order of assembly: pieces of a step slide down, from straight above, onto all of
  /// earlier steps.
  std::size_t step{};
  bool is_island{};  ///< it was no part of the ground's paper: it is held by crossings alone
};

/// Where pieces cross: both are slotted half and half over a stretch of z.
struct SliceCrossing {
  std::size_t x_piece{}, y_piece{};
  double from_mm{}, to_mm{};
  double split_mm{};  ///< the middle: the earlier piece has its paper below it, the later above
};

/// A piece that is left out, and why.
struct DroppedPiece {
  enum class Reason : std::uint8_t { Small, Loose, Blocked };
  std::size_t slice{};
  double area_mm2{};
  Reason reason{};
};

/// Slices with their slots.
struct SliceLattice {
  std::vector<SlicePiece> pieces;  ///< by step
  std::vector<SliceCrossing> crossings;
  std::vector<DroppedPiece> dropped;
  std::size_t cleared{};  ///< stretches in which slices would cross a second time, cut away
  std::array<std::size_t, 2> feet{};  ///< the pieces of x = 0 and y = 0 that are glued
  double paper_mm2{};                 ///< of all slices before they were cut
};

/// Cuts slots in slices and finds the pieces that hold.
///
/// Order: the ground's paper of one family, that of the other, then islands of one, and of the
/// other; or the ground's paper of one family with some of its islands, all of the other family,
/// and the other islands. Of these ways the one that keeps most paper is taken. The foot of the
/// other family comes before all: its slots are above, where its tab does not close them.
///
/// Of two slices that cross the later comes from above: the earlier is cut above the middle of what
/// both have in common, the later below it. Where they have several stretches in common the longest
/// is kept, and in others one of them is cut through; so each piece comes down freely
/// (`comes_down_freely`).
///
/// A piece holds if the lattice's motion alone moves it: both feet hold; so does a piece that
/// crosses two others that hold, and each of two pieces that cross each other if each crosses one
/// that holds. All others are dropped. O(crossings) after Clipper's unions.
///
/// @param least_mm2  smaller pieces are dropped
[[nodiscard]] SliceLattice cross_slices(const std::vector<Slice>& slices, const SlotSize& slot,
                                        double least_mm2);

/// Whether each piece comes down from above past all of earlier steps: on each line in which two
/// slices cross, the paper of the earlier piece ends below that of the later; and nothing of an
/// earlier piece of the same slice is above a later one.
[[nodiscard]] bool comes_down_freely(const std::vector<Slice>& slices, const SliceLattice& lattice);

}  // namespace popcut
