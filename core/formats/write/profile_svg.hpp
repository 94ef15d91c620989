// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <iosfwd>

#include "core/drawing/linework.hpp"
#include "core/result.hpp"

namespace popcut {

/// Writes a dashed drawing for LightBurn: page and coordinates in mm, one layer per colour of its
/// palette, in cutting order: marks green (03), mountain red (02), valley blue (01), cuts and
/// outline black (00). Every dash is a solid path, because LightBurn cuts dashed styles as solid
/// lines.
void write_lightburn_svg(const LineWork& dashed, const std::array<double, 2>& page_mm,
                         std::ostream& out);

/// Writes a drawing with whole folds for Origami Simulator: border black, mountain red, valley
/// blue, cuts green (#00ff00), as plain `line` elements without transforms. Half opacity means a
/// fold of 90 degrees. Origami Simulator merges vertices closer than 3 user units, so the drawing
/// is scaled until its shortest line has 30, by at most 1000. Pen and score lines are left out.
void write_origami_sim_svg(const LineWork& whole, std::ostream& out);

/// The area that a Cricut machine can reach on its mat, inches along x and y.
struct CricutMat {
  double width_in{11.5};
  double height_in{11.5};  ///< 23.5 for the long mat
};

/// Writes a dashed drawing (`micro_cut`) for Cricut Design Space. The page is the mat's area, in
/// inches with a viewBox in mm. The drawing is in its upper left corner, where the machine starts.
///
/// Design Space makes one layer per colour, drops stroke-dasharray and layer names, and rescales
/// drawings without a size. So every dash and line is a separate solid path, in one group per
/// colour: marks green, mountain red, valley blue, cuts and outline black. A drawing that is too
/// wide but fits when turned is turned by 90 degrees. Coordinates are rounded to 1e-6 mm.
///
/// @retval Infeasible  does not fit the mat in either orientation
[[nodiscard]] Result<void> write_cricut_svg(const LineWork& dashed, const CricutMat& mat,
                                            std::ostream& out);

}  // namespace popcut
