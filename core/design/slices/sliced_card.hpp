// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/design/slices/slice_lattice.hpp"
#include "core/design/spec/spec.hpp"
#include "core/design/target/surface_spec.hpp"
#include "core/fit/triangle_soup.hpp"
#include "core/hands/folding.hpp"
#include "core/parts/structure.hpp"
#include "core/progress.hpp"
#include "core/result.hpp"
#include "core/warning.hpp"

namespace popcut {

/// A target as two families of crossing slices that stand between two pages (docs/parts.md).
///
/// In the frame of an opening `b` with the pages' directions `e_R`, `e_L` across the spine `W`, and
/// the angle `f` between spine and slices,
///
///     X = cos f W + sin f e_R,  Y = cos f W + sin f e_L,  Z = X x Y / |X x Y|
///
/// Z is square to X and Y at every opening, so that slices x = c and y = d stay flat and rigid as
/// all places move by `x X + y Y + z Z`. A place stays between the pages if
/// `z + 2 tan f min(x, y) >= 0`; shut it is `(x + y) sin f + z cos f` from the spine. Slices x = 0
/// and y = 0 are glued to the left and the right page.
struct SlicedCard {
  Structure card;  ///< its parts beside the pages are `lattice.pieces`, in their order
  std::vector<Slice> slices;
  SliceLattice lattice;
  double frame_rad{};         ///< f
  double base_mm{};           ///< height of the strips below the target
  double slot_mm{};           ///< width of the slots
  double origin_mm{};         ///< of the frame, on the spine
  TriangleSoup frame_target;  ///< the target in x, y, z of the frame
  TriangleSoup target;        ///< as it stands on the open card: u across, v along the spine, z up
  std::size_t folds{}, tabs{};
  hands::Handwork handwork;
  std::vector<Warning> warnings;
};

/// "x3", "y0", and "x3-2" for the second piece of a slice.
[[nodiscard]] std::vector<std::string> piece_names(const SlicedCard& made);

/// Cuts a solid into slices. It stands on strips of paper; its x axis points along X, its y axis
/// along Y if they are square, else both bisectors agree.
///
/// @retval Malformed, OutOfRange  the surface cannot be read
/// @retval Infeasible  it has no inside, is too small, its slices do not hold each other, or a
///                     given page is too small: with the least that holds them
[[nodiscard]] Result<SlicedCard> sliced_card(const DesignSpec& spec, const SurfaceAssets& assets,
                                             const Progress& progress = {});

}  // namespace popcut
