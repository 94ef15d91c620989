// SPDX-License-Identifier: MIT
#pragma once

#include "core/design/target/surface.hpp"
#include "core/result.hpp"

namespace popcut {

/// What a strip of the sheet takes of its target, and where.
struct StripCut {
  SurfaceSlice slice;
  double s_mm{};  ///< the plane that was cut
};

/// Whether an error says that the surface has nothing in a plane, as beyond a mesh's end or where a
/// radius is not positive.
[[nodiscard]] inline bool is_nothing_there(const Error& error) {
  return error.reason == ErrorReason::Misplaced;
}

/// Cuts the target for a strip from `s_mm - width_mm / 2` to `s_mm + width_mm / 2`: in the plane at
/// `s_mm`; where the target has nothing there, or less than `least_mm` of height or depth, in the
/// middle of the longest stretch of the strip in which it has (found to a 64th of the width).
///
/// @retval as `Surface::cut` at `s_mm`, if no part of the strip has a target
[[nodiscard]] Result<StripCut> cut_strip(const Surface& surface, double s_mm, double width_mm,
                                         double least_mm);

}  // namespace popcut
