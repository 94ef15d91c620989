// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <string>

#include "core/drawing/linework.hpp"
#include "core/result.hpp"
#include "core/drawing/toolpath.hpp"

namespace popcut {

/// Registration marks of a printed sheet, which a cutter searches with its sensor: a filled square
/// at the upper left, an L at the upper right and one at the lower left. Distances are to the outer
/// edges. The machine then counts from the square's outer corner.
struct MarkLayout {
  double left_mm{}, top_mm{};      ///< where the square's outer corner lies on the page
  double width_mm{}, height_mm{};  ///< of the rectangle of the three marks, along carriage and feed
  double square_mm{5};
  double arm_mm{20};     ///< of the Ls
  double line_mm{0.5};   ///< thickness of the Ls
  double search_mm{10};  ///< the search begins so far before the expected corner
  /// What TB51 and TB53 say: arm and thickness (inkscape-silhouette), or thickness and arm
  /// (py_silhouette). Sources disagree, and both report success.
  bool arm_first{true};
  bool four_corners{false};  ///< an L at the lower right too (Cameo 5 Alpha, Cameo Pro MK-II)
  int style{2};              ///< what TB52 says: 2 for Cameo and Portrait, 0 for the SD
};

/// Marks 10 mm from the edges of a page and 30 mm from its far end, which the sensor cannot reach.
///
/// @retval Infeasible  the page is too small to hold marks and a drawing
[[nodiscard]] Result<MarkLayout> marks_for(std::array<double, 2> page_mm);

/// Whether all of a sheet lies between its marks and clear of them: outside nothing is cut, and
/// what is drawn over a mark hides it.
///
/// @retval OutOfRange  marks that cannot be, such as a rectangle smaller than its arms
/// @retval Infeasible  a stroke leaves the rectangle or crosses a mark; place is the stroke
[[nodiscard]] Result<void> check_marks(const MarkLayout& marks, const Toolpath& path);

/// The marks as a page to be printed at true size, black on white.
[[nodiscard]] std::string marks_svg(const MarkLayout& marks, std::array<double, 2> page_mm,
                                    const std::string& title);

}  // namespace popcut
