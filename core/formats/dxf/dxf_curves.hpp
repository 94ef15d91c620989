// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/drawing/toolpath.hpp"

namespace popcut {

/// A point or direction of a DXF drawing.
struct DxfVec {
  double x{}, y{}, z{};
};

/// An affine map of space: `(x, y, z)` goes to `o + x ax + y ay + z az`.
struct DxfFrame {
  DxfVec ax{1, 0, 0}, ay{0, 1, 0}, az{0, 0, 1}, o{};

  [[nodiscard]] DxfVec direction(const DxfVec& d) const;
  [[nodiscard]] DxfVec operator()(const DxfVec& p) const;
  [[nodiscard]] DxfFrame operator*(const DxfFrame& inner) const;
};

[[nodiscard]] DxfVec cross(const DxfVec& a, const DxfVec& b);
/// `a` scaled to length 1; none if its length is 0 or not finite.
[[nodiscard]] std::optional<DxfVec> unit(const DxfVec& a);

/// The object coordinate system of an extrusion direction (210, 220, 230), by the arbitrary axis
/// algorithm of the DXF reference. A direction of length 0 means +z.
[[nodiscard]] DxfFrame dxf_object_frame(const DxfVec& extrusion);

/// Appends chords of `c + a cos t + b sin t`, for t from `from` over `span` (rad), within
/// `tolerance`. A chord over dt deviates by at most `r (1 - cos(dt/2))`, with r the longest
/// semi-axis. Appends the first point only if `with_first`. A full turn ends exactly at its first
/// point.
void flatten_turn(const PagePoint& c, const PagePoint& a, const PagePoint& b, double from,
                  double span, double tolerance, bool with_first, std::vector<PagePoint>& line);

/// The centre of the arc from `p` to `q` with the given bulge, which is the tangent of a quarter of
/// its angle, positive to the left. None for a straight line.
[[nodiscard]] std::optional<DxfVec> bulge_centre(const DxfVec& p, const DxfVec& q, double bulge);

/// A B-spline in the plane, rational if it has weights.
struct DxfSpline {
  int degree{3};
  std::vector<double> knots;    ///< control points + degree + 1 of them
  std::vector<double> weights;  ///< one per control point, or empty
  std::vector<PagePoint> control;
};

inline constexpr int kMostSplineDegree = 11;

/// Returns what is wrong with the spline's numbers; empty if they are valid. Missing knots are
/// filled in, clamped and uniform.
[[nodiscard]] std::string check_spline(DxfSpline& spline);

/// Appends chords of a valid spline. Turns each knot span into a Bezier curve and halves it until
/// its control points lie within `tolerance` of the chord; then so does the curve (convex hull).
/// Stops early at more than `most` points.
void flatten_spline(const DxfSpline& spline, double tolerance, std::size_t most,
                    std::vector<PagePoint>& line);

/// Appends chords of a smooth curve through `fit` (at least two points): cubic, twice continuously
/// differentiable, parametrised by chord length, with free ends unless a tangent is given. `closed`
/// returns to the first point.
void flatten_fit(std::vector<PagePoint> fit, std::optional<PagePoint> from_tangent,
                 std::optional<PagePoint> to_tangent, bool closed, double tolerance,
                 std::size_t most, std::vector<PagePoint>& line);

}  // namespace popcut
