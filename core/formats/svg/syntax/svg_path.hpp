// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "core/drawing/toolpath.hpp"
#include "core/result.hpp"

namespace popcut {

using SvgLines = Polylines;  ///< in user units

/// Draws lines and curves with SVG's pen; chords stay within `tolerance` of their curves.
///
/// A curve with second derivative at most m is within tolerance of n chords for n = sqrt(m / (8
/// tolerance)). With second differences at most d, m is 2 d for a quadratic and 6 d for a cubic
/// Bezier. An arc of radius r takes chords of the angle 2 acos(1 - tolerance / r).
class SvgPen {
 public:
  /// Appends to `lines`. `closes` also closes open lines, as a fill does.
  SvgPen(double tolerance, SvgLines& lines, bool closes = false)
      : tolerance_(tolerance), lines_(lines), closes_(closes) {}

  void move(const PagePoint& to);
  void line(const PagePoint& to);
  void quadratic(const PagePoint& control, const PagePoint& to);
  void cubic(const PagePoint& control0, const PagePoint& control1, const PagePoint& to);
  void arc(double rx, double ry, double turn_deg, bool large, bool sweep, const PagePoint& to);
  void close();
  /// Ends the last line. Only then are all points in `lines`.
  void finish();

  [[nodiscard]] const PagePoint& at() const { return at_; }

 private:
  void add(const PagePoint& to);
  double tolerance_;
  SvgLines& lines_;
  PagePoint at_, start_;
  bool closes_;
  bool down_{false};
};

/// Parses path data (all commands, absolute and relative, repeated and without separators) and
/// appends its lines to `lines`; `closes` as for `SvgPen`.
///
/// @retval Malformed   not path data; the detail gives the character
/// @retval OutOfRange  more than `most_points` points in `lines`
[[nodiscard]] Result<void> read_svg_path(std::string_view data, double tolerance,
                                         std::size_t most_points, SvgLines& lines,
                                         bool closes = false);

}  // namespace popcut
