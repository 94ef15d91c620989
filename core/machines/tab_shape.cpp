// SPDX-License-Identifier: MIT
#include "core/machines/tab_shape.hpp"

#include <cmath>

#include <fmt/format.h>

namespace popcut {

double TabShape::min_stretch_mm() const { return min_root_mm + 2 * clearance_mm; }

Result<void> check_tab_shape(const TabShape& shape, const std::string& place) {
  const auto wrong = [&](const char* field, double value, const char* right) {
    return fail(ErrorKind::OutOfRange, place + "/" + field,
                fmt::format("{:g} is out of range; use {}", value, right));
  };
  if (!(shape.depth_mm > 0.0 && shape.depth_mm <= 200.0))
    return wrong("depth_mm", shape.depth_mm, "more than 0 and at most 200 mm");
  if (!(shape.min_depth_mm > 0.0 && shape.min_depth_mm <= shape.depth_mm))
    return wrong("min_depth_mm", shape.min_depth_mm, "more than 0 and at most depth_mm");
  if (!(shape.side_rad >= 0.3 && shape.side_rad <= 1.5707))
    return wrong("side_deg", shape.side_rad * 57.29577951308232, "18 to 89.9 degrees");
  if (!(shape.pitch_mm >= 5.0 && shape.pitch_mm <= 10000.0))
    return wrong("pitch_mm", shape.pitch_mm, "5 to 10000 mm");
  if (!(shape.clearance_mm >= 0.0 && shape.clearance_mm <= 20.0))
    return wrong("clearance_mm", shape.clearance_mm, "0 to 20 mm");
  if (!(shape.min_root_mm > 0.0 && shape.min_root_mm <= shape.pitch_mm))
    return wrong("min_root_mm", shape.min_root_mm, "more than 0 and at most pitch_mm");
  if (shape.min_stretch_mm() > shape.pitch_mm)
    return wrong("pitch_mm", shape.pitch_mm, "more than min_root_mm plus both clearances");
  return {};
}

}  // namespace popcut
