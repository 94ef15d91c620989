// SPDX-License-Identifier: MIT
#pragma once

#include <functional>

#include "core/design/target/curve.hpp"
#include "core/design/target/monotone_fit.hpp"
#include "core/design/target/surface_spec.hpp"
#include "core/result.hpp"

namespace popcut {

/// A target surface, seen by the design as its slices: for each place s along the spine (mm) the
/// curve that the plane v = s cuts out of it (docs/geometry.md, section 3).
///
/// A slice is an error of its own: OutOfRange where the surface is not finite and positive there,
/// Infeasible where it is not in the corner or (FitMode::Exact) its curve does not fall from the
/// wall to the ground; `place` names s.
class Surface {
 public:
  /// Parses expressions and files; what is sliced often is indexed here, once.
  ///
  /// @param assets  contents of the file that the surface names; not kept
  /// @retval Malformed   the expression does not parse, the file is absent or not of its kind
  /// @retval OutOfRange  a value in the file is not valid, or the file is too large
  /// @retval Infeasible  no part of the mesh is in the corner
  [[nodiscard]] static Result<Surface> make(const SurfaceSpec& spec,
                                            const TargetPlacement& placement, FitMode fit,
                                            const SurfaceAssets& assets = {});

  /// The curve with what it leaves out of the target.
  [[nodiscard]] Result<SurfaceSlice> cut(double s_mm) const { return slice_(s_mm); }
  [[nodiscard]] Result<SliceCurve> slice(double s_mm) const {
    auto cut_there = slice_(s_mm);
    if (!cut_there) return tl::unexpected(cut_there.error());
    return std::move(cut_there->curve);
  }

  using Slicer = std::function<Result<SurfaceSlice>(double)>;
  explicit Surface(Slicer slice) : slice_(std::move(slice)) {}

 private:
  Slicer slice_;
};

}  // namespace popcut
