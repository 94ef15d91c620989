// SPDX-License-Identifier: MIT
#pragma once

#include <iosfwd>

#include "core/drawing/linework.hpp"
#include "core/result.hpp"

namespace popcut {

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
