// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/fit/triangle_soup.hpp"

namespace popcut {

/// A picture of square cells that is seen from the front: columns from left to right, half of them
/// on each side of the middle, rows from the page upward.
struct LayerGrid {
  double cell_mm{};
  std::size_t columns{}, rows{};  ///< columns are even

  [[nodiscard]] std::size_t cells() const { return columns * rows; }
  [[nodiscard]] std::size_t at(std::size_t column, std::size_t row) const {
    return row * columns + column;
  }
};

/// How layers are looked at: a place of the target goes to the paper along this look.
struct LayerLook {
  double fall{};  ///< how far a ray falls for each mm that it goes back: the tangent of its angle
  double bend{};  ///< how far paper lies farther back for each mm beside the middle; else nearer
  /// The foremost layer goes back from a broad front of the target, which would sink into the page.
  bool lifts_front{};

  /// How far behind its own middle the paper lies `aside_mm` beside it.
  [[nodiscard]] double behind_mm(double aside_mm) const {
    return bend * (aside_mm < 0.0 ? -aside_mm : aside_mm);
  }
  /// The share of that by which the picture on a layer is raised.
  [[nodiscard]] double raised_share(std::size_t layer) const {
    return layer == 0 && lifts_front ? 1.0 : 0.0;
  }
};

/// Which cells of a grid are paper: 1, or 0.
using LayerMask = std::vector<std::uint8_t>;

/// A depth at which a surface is crossed from the front on, mm behind its foremost point, less what
/// the paper there is behind its middle.
struct DepthCrossing {
  float depth_mm{};
  bool enters{};  ///< the surface looks to the front
};

/// What a target has behind each cell. A row is where a ray meets the plane of the foremost point.
struct DepthStacks {
  LayerGrid grid;
  LayerLook look;
  std::vector<std::vector<DepthCrossing>> crossings;  ///< one a cell, ascending
};

/// Looks through a target, whose x axis points to the front, y to the right and z up, from z = 0
/// on. The grid has all of it, and at least `least_half_mm` on each side of the middle.
[[nodiscard]] DepthStacks depth_stacks(TriangleSoup target, const LayerLook& look, double cell_mm,
                                       double least_half_mm = 0.0);

/// Fills the cells around each place where two cells of paper touch in a corner only, so that the
/// border of paper is a simple polygon. One pass over the rows, which can leave new ones.
///
/// @param columns  cells of a row of `mask`
/// @return whether it filled any
bool fill_corners(std::size_t columns, LayerMask& mask);

/// The height of a layer, mm.
[[nodiscard]] double height_of(const LayerGrid& grid, const LayerMask& mask);

/// The depths of at most `count` layers that lie nearest to what is seen of a target from in front
/// and above (k-medians), moved as little as puts each at least `apart_mm` behind the last; fewer
/// where the target is not deep enough. Ascending.
[[nodiscard]] std::vector<double> layer_depths(const TriangleSoup& target, int count,
                                               double apart_mm);

/// The layers of a target: each has all of the target that is nearer in depth to it than to another
/// layer, whether it is seen or not, where the look shows it on the layer. Solids that overlap are
/// one.
[[nodiscard]] std::vector<LayerMask> layer_masks(const DepthStacks& stacks,
                                                 const std::vector<double>& depths_mm);

/// How a layer becomes one piece of paper that stands on the page.
struct LayerPaper {
  double band_mm{6.0};         ///< height of the strip at its foot that holds all of it
  double least_foot_mm{22.0};  ///< of that strip, on each side of the middle
  double foot_share{0.45};     ///< the same, of the layer's height
  double widest_foot_mm{1e9};  ///< the most of all these
  double firm_foot_mm{};       ///< the least, however wide that is
  double ridge_mm{16.0};       ///< least height of the fold in the middle
  double ridge_share{0.42};    ///< the same, of the layer's height
  double hidden_share{0.5};    ///< the same, well below what hides it in front
  double bridge_mm{5.0};       ///< width of paper that joins parts
  double least_mm2{20.0};      ///< smaller parts are left out, smaller holes are filled
  bool may_miss_half{};        ///< nothing needs paper on both sides of the middle
};

/// What was done to a layer.
struct LayerChanges {
  std::size_t dropped{};  ///< parts that were too small
  std::size_t bridges{};  ///< strips of paper that join parts
  double shown_mm2{};     ///< of strips, where no layer in front hides them
  std::size_t filled{};   ///< holes
};

/// Paper of a layer that stands in one plane, without a fold in the middle.
[[nodiscard]] LayerPaper unfolded_paper();

/// Makes each half of a layer one piece, which stands on the page and meets the other
/// half in the middle. Parts are joined where `hidden` (layers in front) hides the paper, if there
/// is a way; else by the shortest.
[[nodiscard]] LayerChanges make_one_piece(const LayerGrid& grid, const LayerMask& hidden,
                                          const LayerPaper& paper, LayerMask& mask);

}  // namespace popcut
