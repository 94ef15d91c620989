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

/// Writes a drawing for Cricut Design Space, which has an operation for each layer: draw, score or
/// cut. One group and one colour an operation: pen lines (green), folds that are pressed with its
/// stylus or wheel (red, whole lines), cuts and the outline (black). Folds of a `dashed` drawing
/// (`micro_cut`) are dashes to cut, so they are black too. Pen lines and scores are one path each,
/// so that they are one layer there; every cut and dash is a path of its own, closed where the line
/// is. There are no dashed styles, which Design Space drops.
///
/// The page is the mat's area, with the drawing in its upper left corner, where the machine starts.
/// Its size is in inches, and a unit of the viewBox is a point: Design Space, which takes units
/// without a size for points (1/72 inch), reads the same size from either. A drawing that is too
/// wide but fits when turned is turned by 90 degrees.
///
/// @retval Infeasible  does not fit the mat in either orientation
[[nodiscard]] Result<void> write_cricut_svg(const LineWork& drawing, const CricutMat& mat,
                                            std::ostream& out);

}  // namespace popcut
