// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <iosfwd>

#include "core/pattern/pattern.hpp"

namespace popcut {

/// How a deployed pattern is looked at, and how large the picture is.
struct View {
  double azimuth_rad{0.5};  ///< of the eye, from straight ahead toward growing v; 0 < it < pi/2
  double width_px{900.0};
  double px_per_mm{0.0};  ///< a scale instead of `width_px`; 0: as large as fills the width
};

/// Draws `pattern` opened to `psi_rad` as a shaded picture seen from the pop-up side, parallel
/// projection, v to the right and z up, the eye on the bisector of wall and ground.
///
/// The order of painting is exact, not a sort by depth: faces are cut along the lines where strips
/// meet, and no point of a strip hides another of the same strip, since each is a monotone
/// staircase that the eye sees from within the opening; so painting strip by strip toward the eye
/// is right. 0 < psi_rad <= pi.
void write_deployed_svg(const Pattern& pattern, double psi_rad, const View& view,
                        std::ostream& out);

/// Width and height of that picture in px, before they are rounded up.
[[nodiscard]] std::array<double, 2> deployed_size_px(const Pattern& pattern, double psi_rad,
                                                     const View& view);

}  // namespace popcut
