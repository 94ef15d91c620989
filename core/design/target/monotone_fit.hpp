// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/design/target/section.hpp"
#include "core/design/target/surface_spec.hpp"
#include "core/result.hpp"

namespace popcut {

/// The falling curve nearest to an outline.
struct FallingFit {
  std::vector<SectionPoint> points;  ///< from (0, h) to (d, 0): x never falls, z never rises
  std::vector<double> moved_mm;      ///< how far each outline point was moved
  double max_moved_mm{};
  SectionPoint worst;  ///< the outline's point that was moved farthest
};

/// Least squares over all curves that fall from the wall to the ground, weighted by length.
///
/// Along the outline x must not fall and z must not rise, and the two do not hinder each other:
/// each is an isotonic regression, solved exactly in O(k) by pooling adjacent violators (Barlow et
/// al., Statistical Inference under Order Restrictions, 1972). A curve that falls is its own fit.
/// Where the outline stops short of wall or ground, it goes on level or upright, at no weight.
/// Neither has weight what lies more than a tenth of the outline's size behind its outermost
/// points, in x and in z, as the underside of an overhang: it would draw the curve away from what
/// can be reached.
[[nodiscard]] FallingFit nearest_falling(std::span<const OutlinePoint> outline);

/// A curve through a falling polyline (`SliceCurve::through`). Stretches that are level or upright
/// for more than a hundredth of the chord are tilted by `kFallMargin`, so that each unit falls.
[[nodiscard]] SliceCurve strictly_falling(std::vector<SectionPoint> points);
inline constexpr double kFallMargin = 1e-3;

/// A slice of a target with what it leaves out.
struct SurfaceSlice {
  SliceCurve curve;
  SliceFit fit;
};

/// Section to curve. What the user sees of `what` ("mesh", "solid") at `place` is in the errors.
///
/// @retval Infeasible  nothing is in the corner; or, with FitMode::Exact, the section has a hole,
///                     stops short of wall or ground, or is not followed by any falling curve to a
///                     hundred-thousandth of its size; `detail` names the point
[[nodiscard]] Result<SurfaceSlice> fit_section(const Section& section, FitMode mode,
                                               const std::string& place, const char* what);

}  // namespace popcut
