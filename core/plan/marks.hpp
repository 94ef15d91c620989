// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/drawing/linework.hpp"
#include "core/drawing/toolpath.hpp"
#include "core/result.hpp"

namespace popcut {

/// Registration marks of a printed sheet, which a cutter finds with its sensor: a filled square at
/// the upper left, an L at the upper right and an L at the lower left. Distances are to the outer
/// edges. After the search the machine counts from the square's outer corner.
struct MarkLayout {
  double left_mm{}, top_mm{};      ///< outer corner of the square on the page
  double width_mm{}, height_mm{};  ///< rectangle around the three marks, along carriage and feed
  double square_mm{5};
  double arm_mm{20};    ///< arm length of the Ls
  double line_mm{0.5};  ///< thickness of the Ls
  /// The order of the arguments of TB51 and TB53: arm and thickness (inkscape-silhouette) or
  /// thickness and arm (py_silhouette). The sources disagree; both report success.
  bool arm_first{true};
  bool four_corners{false};  ///< also an L at the lower right (Cameo 5 Alpha, Cameo Pro MK-II)
  int style{2};              ///< argument of TB52: 2 for Cameo and Portrait, 0 for the SD
};

/// Marks 10 mm from the edges of a page and 30 mm from its far end, which the sensor cannot reach.
///
/// @retval Infeasible  the page is too small for marks and a drawing
[[nodiscard]] Result<MarkLayout> marks_for(std::array<double, 2> page_mm);

/// What is printed of marks, on the page in mm: the square, and two bars for each L.
[[nodiscard]] std::vector<Box> mark_boxes(const MarkLayout& marks);

/// How far right of and below the page's corner a drawing must begin to stay clear of the marks.
inline constexpr double kBesideMarksMm = 16.0;

/// How far right and down on a page a drawing may reach that stays clear of the marks of
/// `marks_for`, mm; its upper left corner is to be at `kBesideMarksMm` or beyond.
[[nodiscard]] std::array<double, 2> within_marks_mm(std::array<double, 2> page_mm);

/// The largest drawing that stays clear of the marks of a page, mm; 0 on a page too small for any.
[[nodiscard]] std::array<double, 2> room_within_marks_mm(std::array<double, 2> page_mm);

/// Checks that all strokes of a sheet lie between its marks and clear of them. The machine cuts
/// nothing outside, and lines printed over a mark hide it.
///
/// @retval OutOfRange  impossible marks, such as a rectangle smaller than its arms
/// @retval Infeasible  a stroke leaves the rectangle or crosses a mark; place is the stroke
[[nodiscard]] Result<void> check_marks(const MarkLayout& marks, const Toolpath& path);

/// The marks as an SVG page to print at true size, black on white.
[[nodiscard]] std::string marks_svg(const MarkLayout& marks, std::array<double, 2> page_mm,
                                    const std::string& title);

}  // namespace popcut
