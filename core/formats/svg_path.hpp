// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/result.hpp"
#include "core/toolpath.hpp"

namespace popcut {

/// Polylines in user units. A closed one repeats its first point.
using SvgLines = std::vector<std::vector<PagePoint>>;

/// Draws with SVG's pen: curves become chords that stay within `tolerance` of them.
///
/// A curve of second derivative at most m is within tolerance of n chords for n = sqrt(m / (8
/// tolerance)); m is 2 d for a quadratic and 6 d for a cubic Bezier with second differences at most
/// d. An arc of radius r takes chords of the angle 2 acos(1 - tolerance / r).
class SvgPen {
 public:
  explicit SvgPen(double tolerance) : tolerance_(tolerance) {}

  void move(const PagePoint& to);
  void line(const PagePoint& to);
  void quadratic(const PagePoint& control, const PagePoint& to);
  void cubic(const PagePoint& control0, const PagePoint& control1, const PagePoint& to);
  void arc(double rx, double ry, double turn_deg, bool large, bool sweep, const PagePoint& to);
  void close();

  [[nodiscard]] const PagePoint& at() const { return at_; }
  [[nodiscard]] std::size_t points() const { return points_; }
  /// All lines; the pen starts anew.
  [[nodiscard]] SvgLines take();

 private:
  void add(const PagePoint& to);
  double tolerance_;
  SvgLines lines_;
  PagePoint at_, start_;
  bool down_{false};
  std::size_t points_{};
};

/// Follows path data (all commands, absolute and relative, repeated and run together).
///
/// @retval Malformed   it is not path data; the detail says at which character
/// @retval OutOfRange  more than `most_points` points
[[nodiscard]] Result<SvgLines> parse_svg_path(std::string_view data, double tolerance,
                                              std::size_t most_points);

}  // namespace popcut
