// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <string>

#include "core/design/curve.hpp"
#include "core/design/spec.hpp"
#include "core/result.hpp"

namespace popcut {

/// A target surface, seen by the design as its slices: for each place s along the spine (mm) the
/// curve that the plane v = s cuts out of it (design reference, section 3).
///
/// A slice is an error of its own: OutOfRange where the surface is not finite and positive there,
/// Infeasible where its curve does not fall from the wall to the ground; `place` names s.
class Surface {
 public:
  /// @retval Malformed  the expression does not parse
  [[nodiscard]] static Result<Surface> make(const SurfaceSpec& spec, double scale_mm);

  [[nodiscard]] Result<SliceCurve> slice(double s_mm) const { return slice_(s_mm); }

 private:
  using Slicer = std::function<Result<SliceCurve>(double)>;
  explicit Surface(Slicer slice) : slice_(std::move(slice)) {}
  Slicer slice_;
};

}  // namespace popcut
