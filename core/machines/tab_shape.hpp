// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "core/result.hpp"

namespace popcut {

/// Shape of a material's glue tabs. A tab is a trapezoid that lies flat under the panel beyond the
/// seam. Its root is the edge on the seam.
struct TabShape {
  double depth_mm{6.0};                 ///< depth where there is room
  double min_depth_mm{2.0};             ///< least depth: a shallower tab does not hold
  double side_rad{1.0471975511965976};  ///< angle between root and sides
  double pitch_mm{40.0};                ///< longest root
  double clearance_mm{0.5};  ///< free space at both ends of the root and to each line under the tab
  double min_root_mm{1.5};   ///< shortest root; roots too short for a trapezoid carry a triangle

  /// The shortest stretch of a seam that can hold a tab, mm.
  [[nodiscard]] double min_stretch_mm() const;
  friend bool operator==(const TabShape&, const TabShape&) = default;
};

/// Checks that all sizes are within range.
///
/// @retval OutOfRange  a size is out of range; its place is `place`/FIELD
[[nodiscard]] Result<void> check_tab_shape(const TabShape& shape, const std::string& place);

}  // namespace popcut
