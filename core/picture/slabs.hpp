// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/pattern/pattern.hpp"

namespace popcut {

/// Where a panel of a slab lies.
enum class PanelPlace : std::uint8_t { Wall, Ground, Structure };

/// A point of a slab's section by its place in the designed pose, mm.
struct SectionPlace {
  double x{}, z{};
};

/// The part of a panel between the two borders of a slab, bounded by two edges a and b of the panel
/// (a nearer to the wall's upper edge); places in the designed pose, mm.
struct SlabPanel {
  SectionPlace low_a, high_a;  ///< of the one edge, at the slab's lower and upper v
  SectionPlace low_b, high_b;
  PanelPlace place{};
  bool is_upright{};          ///< parallel to the wall
  std::uint32_t face{kNone};  ///< of the pattern
  const Kite* kite{};         ///< that it is a panel of; its places are then those of the stair
  bool is_roof{};             ///< the longer panel of a kite: nothing of the kite hides it

  static constexpr std::uint32_t kNone = UINT32_MAX;

  /// Corners (x, z, v) in the order low a, low b, high b, high a.
  [[nodiscard]] std::array<PatternVertex, 4> corners(double low_mm, double high_mm) const;
};

/// A part of an edge, drawn with the slab that it bounds or crosses.
struct SlabStroke {
  PatternVertex from, to;
  bool is_fold{};
  const Kite* kite{};  ///< that it bounds
  bool is_of_roof{};   ///< it bounds the longer panel of the kite
};

/// What lies between two neighbouring places along the spine.
struct Slab {
  double low_mm{}, high_mm{};          ///< along v
  std::vector<SlabPanel> panels;       ///< from the wall's upper edge to the ground's far edge
  std::vector<SlabStroke> strokes;     ///< none where the pattern is thinned
  std::vector<std::uint32_t> v_folds;  ///< V-folds whose triangles end here

  /// The card's paper that was cut out for the structure and is missing now: on the wall from the
  /// spine up to where the structure begins, and on the ground from the spine to where it ends.
  /// None where nothing is missing.
  [[nodiscard]] std::vector<SlabPanel> holes() const;
};

/// A pattern cut into slabs, in the order in which an eye looking from the pop-up side and from
/// beyond the last slab has them painted: the first one first.
///
/// That order is exact. On the way from any point to the eye v never falls, so what hides a point
/// lies in its own slab or a later one; and within a slab nothing hides anything, because each slab
/// is a staircase that the eye sees from within the opening: from a point outside of the staircase
/// the way to the eye stays outside. Holes are behind all panels of their slab, and V-folds, which
/// stand in the valleys, before them. So do kites: the shorter panel first, which the roof may
/// hide. Kites are those of the pattern, which must outlive the slabs.
struct Slabs {
  std::vector<Slab> slabs;
  int every_strip{1};  ///< of so many strips one is drawn, as wide as all of them
  int every_step{1};   ///< so many steps of a staircase are drawn as one
};

/// @param most_panels  a pattern with more panels is thinned to about so many
[[nodiscard]] Slabs cut_into_slabs(const Pattern& pattern, std::size_t most_panels);

}  // namespace popcut
