// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/drawing/linework.hpp"
#include "core/geometry/vec.hpp"

namespace popcut {

/// An affine map of space: `(x, y, z)` goes to `o + x ax + y ay + z az`.
struct DxfFrame {
  Vec3 ax{1, 0, 0}, ay{0, 1, 0}, az{0, 0, 1}, o{};

  [[nodiscard]] Vec3 direction(const Vec3& d) const { return d.x() * ax + d.y() * ay + d.z() * az; }
  [[nodiscard]] Vec3 operator()(const Vec3& p) const { return o + direction(p); }
  [[nodiscard]] DxfFrame operator*(const DxfFrame& inner) const {
    return {direction(inner.ax), direction(inner.ay), direction(inner.az), (*this)(inner.o)};
  }
};

/// `a` scaled to length 1; none if its length is 0 or not finite.
[[nodiscard]] std::optional<Vec3> dxf_unit(const Vec3& a);

/// The object coordinate system of an extrusion direction (210, 220, 230), by the arbitrary axis
/// algorithm of the DXF reference. A direction of length 0 means +z.
[[nodiscard]] DxfFrame dxf_object_frame(const Vec3& extrusion);

/// Appends chords of `c + a cos t + b sin t`, for t from `from` over `span` (rad), within
/// `tolerance`. A chord over dt deviates by at most `r (1 - cos(dt/2))`, with r the longest
/// semi-axis. Appends the first point only if `with_first`. A full turn ends exactly at its first
/// point.
void flatten_turn(const PagePoint& c, const PagePoint& a, const PagePoint& b, double from,
                  double span, double tolerance, bool with_first, std::vector<PagePoint>& line);

/// The centre of the arc from `p` to `q` with the given bulge, which is the tangent of a quarter of
/// its angle, positive to the left. None for a straight line.
[[nodiscard]] std::optional<Vec3> bulge_centre(const Vec3& p, const Vec3& q, double bulge);

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

/// A line type as parts of its period.
struct DxfDashes {
  struct Part {
    double from{}, to{};  ///< fraction of the period, 0..1
  };
  std::vector<Part> dashes;  ///< half of the last gap comes before the first dash
  double period{};           ///< in drawing units
};

/// The dashes of a line type's elements (above 0 a dash, below 0 a gap, 0 a dot, which cannot be
/// cut). Empty unless there are both dashes and gaps.
[[nodiscard]] DxfDashes dxf_dashes(std::span<const double> elements);

/// How many periods of `period` (mm) a line of `length` gets: at least one.
[[nodiscard]] double dxf_periods(double length, double period);

/// Calls `put(points)` for each dash of `line`, with `periods` periods end to end.
template <typename Put>
bool each_dash(std::span<const PagePoint> line, const DxfDashes& dashes, double periods, Put put) {
  const double l = length(line) / periods;  // of one period
  std::vector<PagePoint> dash;
  std::size_t i = 1;
  double before = 0.0;  // length up to line[i - 1]
  const auto go_to = [&](double s, bool keep) {
    double edge = distance(line[i - 1], line[i]);
    while (i + 1 < line.size() && before + edge < s) {
      before += edge;
      if (keep) dash.push_back(line[i]);
      ++i;
      edge = distance(line[i - 1], line[i]);
    }
    const double t = edge > 0.0 ? (s - before) / edge : 0.0;
    dash.push_back(lerp(line[i - 1], line[i], t < 0.0 ? 0.0 : t > 1.0 ? 1.0 : t));
  };
  for (double k = 0; k < periods; k += 1.0)
    for (const DxfDashes::Part& part : dashes.dashes) {
      dash.clear();
      go_to((k + part.from) * l, false);
      go_to((k + part.to) * l, true);
      if (!put(std::span<const PagePoint>(dash))) return false;
    }
  return true;
}

}  // namespace popcut
