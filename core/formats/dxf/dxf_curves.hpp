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
/// `a` with length 1; none if it has no length or no finite one.
[[nodiscard]] std::optional<DxfVec> unit(const DxfVec& a);

/// The object coordinate system of an extrusion direction (210, 220, 230): the arbitrary axis
/// algorithm of the DXF reference. A direction of no length is +z.
[[nodiscard]] DxfFrame dxf_object_frame(const DxfVec& extrusion);

/// Chords of `c + a cos t + b sin t` for t from `from` over `span`, within `tolerance`. A chord
/// over dt is off by at most `r (1 - cos(dt/2))` with r the longest semi-axis. The first point is
/// appended only if `with_first`; a full turn ends in the very first point.
void flatten_turn(const PagePoint& c, const PagePoint& a, const PagePoint& b, double from,
                  double span, double tolerance, bool with_first, std::vector<PagePoint>& line);

/// The arc from `p` to `q` whose `bulge` is the tangent of a quarter of its angle, positive to the
/// left: its centre. None for a straight one.
[[nodiscard]] std::optional<DxfVec> bulge_centre(const DxfVec& p, const DxfVec& q, double bulge);

/// A B-spline in the plane, rational if it has weights.
struct DxfSpline {
  int degree{3};
  std::vector<double> knots;    ///< control points + degree + 1 of them
  std::vector<double> weights;  ///< as many as control points, or none
  std::vector<PagePoint> control;
};

inline constexpr int kMostSplineDegree = 11;

/// What is wrong with the spline's numbers, empty if nothing is. Knots that are not given are made:
/// clamped and uniform.
[[nodiscard]] std::string check_spline(DxfSpline& spline);

/// Chords of a sound spline. Each knot span is made a Bezier curve and halved until its control
/// points lie within `tolerance` of the chord, so that the curve does, too (convex hull). Ends
/// early when there are more than `most` points.
void flatten_spline(const DxfSpline& spline, double tolerance, std::size_t most,
                    std::vector<PagePoint>& line);

/// A smooth curve through `fit` (at least two): cubic, twice continuous, chord length as parameter,
/// free ends unless a tangent is given. `closed` goes back to the first point.
void flatten_fit(std::vector<PagePoint> fit, std::optional<PagePoint> from_tangent,
                 std::optional<PagePoint> to_tangent, bool closed, double tolerance,
                 std::size_t most, std::vector<PagePoint>& line);

}  // namespace popcut
