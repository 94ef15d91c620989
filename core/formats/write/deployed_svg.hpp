// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <iosfwd>

#include "core/pattern/pattern.hpp"

namespace popcut {

/// The viewing direction of a picture of a deployed pattern, and the picture's size.
struct View {
  double azimuth_rad{
      0.5};  ///< direction of the eye, from straight ahead towards growing v; 0 < azimuth < pi/2
  double width_px{900.0};
  double px_per_mm{0.0};  ///< fixed scale in place of `width_px`; 0: fill the width
};

/// Draws `pattern` opened to `psi_rad` (0 < psi_rad <= pi) as a shaded picture seen from the pop-up
/// side: parallel projection, v to the right, z up, the eye on the bisector of wall and ground.
///
/// The painting order is exact, not sorted by depth. Faces are cut along the lines where strips
/// meet. No point of a strip hides another point of the same strip, because each strip is a
/// monotone staircase that the eye sees from within the opening. So it is correct to paint strip by
/// strip towards the eye.
void write_deployed_svg(const Pattern& pattern, double psi_rad, const View& view,
                        std::ostream& out);

/// Width and height of that picture in px, not yet rounded up.
[[nodiscard]] std::array<double, 2> deployed_size_px(const Pattern& pattern, double psi_rad,
                                                     const View& view);

}  // namespace popcut
