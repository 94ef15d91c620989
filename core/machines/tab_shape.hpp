// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "core/result.hpp"

namespace popcut {

/// Glue tabs of a material. A tab is a trapezoid that lies flat under the panel beyond the seam.
struct TabShape {
  double depth_mm{6.0};                 ///< as deep as this where there is room
  double min_depth_mm{2.0};             ///< never less: it would not hold
  double side_rad{1.0471975511965976};  ///< between root and sides
  double pitch_mm{40.0};                ///< longest root
  double clearance_mm{0.5};             ///< from its root's ends and from every line under it
  double min_root_mm{1.5};  ///< shortest root; below a trapezoid's least one it is a triangle

  /// The shortest stretch that can hold a tab.
  [[nodiscard]] double min_stretch_mm() const;
  friend bool operator==(const TabShape&, const TabShape&) = default;
};

/// @retval OutOfRange  a value that no tab can have; `place` is put before the field's name
[[nodiscard]] Result<void> check_tab_shape(const TabShape& shape, const std::string& place);

}  // namespace popcut
