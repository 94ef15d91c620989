// SPDX-License-Identifier: MIT
#pragma once

#include <iosfwd>

#include "core/drawing/linework.hpp"
#include "core/result.hpp"

namespace popcut {

/// What a Cricut machine can reach on its mat, inches along x and y.
struct CricutMat {
  double width_in{11.5};
  double height_in{11.5};  ///< 23.5 on the long mat
};

/// Draws a dashed drawing (`micro_cut`) for Cricut Design Space: the page is the mat's area, in
/// inches with a viewBox in mm, the drawing in its upper left corner, where the machine starts.
///
/// That program takes each colour for a layer, drops stroke-dasharray and layers' names, and scales
/// what has no size; so every dash and line is a solid path of its own, one colour a group:
/// marks green, mountain red, valley blue, cuts and outline black. A drawing that is too wide but
/// fits when turned is turned by 90 degrees. Places are rounded to 1e-6 mm.
///
/// @retval Infeasible  it does not fit the mat either way
[[nodiscard]] Result<void> write_cricut_svg(const LineWork& dashed, const CricutMat& mat,
                                            std::ostream& out);

}  // namespace popcut
