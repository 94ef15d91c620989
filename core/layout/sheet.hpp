// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "core/drawing/linework.hpp"
#include "core/machines/machine.hpp"

namespace popcut {

/// Whether `word` is the mat's name, ignoring case ("12X12").
[[nodiscard]] bool is_mat_name(const Mat& mat, std::string_view word);

/// Parses width and length: "300x200", "300x200mm", "12x12in", "30.5x30.5cm", or a paper's name
/// such as "A4" or "letter-landscape" (see `find_paper`). Result in mm. What can be read as a size
/// is one: "12x12" is 12 mm.
///
/// @retval Usage  not a size, or a side is not between 1 mm and 100 m
[[nodiscard]] Result<std::array<double, 2>> parse_size_mm(std::string_view text);

/// Whether `mat` names no mat but a roll: a sheet as long as what is cut from it.
[[nodiscard]] bool is_roll(std::string_view mat);

/// Finds the mat that `wanted` means on `machine`: one of its mats by name, a paper, or a size (mat
/// code 0: popcut sends no mat). Empty: the machine's first mat, or its whole area.
///
/// @retval Usage       neither a known name nor a size
/// @retval OutOfRange  larger than the machine, or too small to print on
[[nodiscard]] Result<Mat> choose_mat(const Machine& machine, std::string_view wanted);

/// An ideal plotter of the given size: GPGL in 0.05 mm units without the limits of a real machine.
[[nodiscard]] Result<Machine> ideal_plotter(double width_mm, double length_mm);

/// What a printed page keeps free around its area, mm: left, above and right, where many printers
/// print nothing; and below, for the legend.
inline constexpr double kPrintSideMm = 8.0, kPrintFooterMm = 30.0;

/// The part of the mat that the tool can reach, mm along carriage and feed. By hand it is the part
/// of the paper within those margins.
[[nodiscard]] std::array<double, 2> reach_mm(const Machine& machine, const Mat& mat);

/// A rigid move from the page to the sheet: (x, y) -> (xx x + xy y + x0, yx x + yy y + y0).
struct Placement {
  double xx{1}, xy{0}, x0{0};
  double yx{0}, yy{1}, y0{0};
  [[nodiscard]] PagePoint operator()(const PagePoint& p) const {
    return {xx * p.x + xy * p.y + x0, yx * p.x + yy * p.y + y0};
  }
};

/// Where to place a drawing.
struct PlaceOptions {
  std::optional<PagePoint> at{};  ///< upper left corner of the drawing on the sheet, mm
  bool clip{false};               ///< drop what lies outside the area
  /// `at` is nobody's wish: the drawing may be turned there, and without room it is too large.
  bool at_is_usual{false};
};

/// Places the drawing on an area of `reach` mm. A drawing with its own page stays where it is if it
/// lies inside the area. Other drawings get a margin of up to 10 mm, and a turn by 90 degrees only
/// if they fit no other way. Never mirrored: the determinant is always +1.
///
/// @retval Infeasible  does not fit and `clip` is not set; the detail has both sizes
[[nodiscard]] Result<Placement> place(const LineWork& work, const std::array<double, 2>& reach,
                                      const PlaceOptions& options);

/// The drawing with all points moved by `placement`.
[[nodiscard]] LineWork placed(LineWork work, const Placement& placement);

/// The part of the drawing within [room, width - room] x [room, length - room]. Each line is cut
/// exactly at the border; what remains becomes separate lines. Lines along the border count as
/// inside.
[[nodiscard]] LineWork clipped(const LineWork& work, const std::array<double, 2>& reach,
                               double room = 0.0);

}  // namespace popcut
