// SPDX-License-Identifier: MIT
#include "core/plan/marks.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/text/svg_document.hpp"

namespace popcut {
namespace {

constexpr double kInsetMm = 10;
constexpr double kFarInsetMm = 30;
constexpr double kClearMm = 2;   // of the bars, and of what is printed around the sheet's outline
constexpr double kLeastMm = 60;  // two arms of 20 mm and space between them

Result<void> check_shape(const MarkLayout& m) {
  const bool finite = std::isfinite(m.left_mm) && std::isfinite(m.top_mm) &&
                      std::abs(m.left_mm) < kMaxCoordinate && std::abs(m.top_mm) < kMaxCoordinate;
  const bool sized = m.width_mm < kMaxCoordinate && m.height_mm < kMaxCoordinate &&
                     m.width_mm >= 2 * m.arm_mm && m.height_mm >= 2 * m.arm_mm;
  const bool marks = m.arm_mm > 0 && m.line_mm > 0 && m.line_mm < m.arm_mm && m.square_mm > 0 &&
                     m.square_mm <= m.arm_mm;
  if (finite && sized && marks) return {};
  return fail(
      ErrorKind::OutOfRange, "marks",
      fmt::format("the marks' rectangle is {:g} x {:g} mm with arms of {:g} mm; make both sides at "
                  "least twice as long as the arms",
                  m.width_mm, m.height_mm, m.arm_mm));
}

}  // namespace

std::vector<Box> mark_boxes(const MarkLayout& m) {
  const double left = m.left_mm, top = m.top_mm, right = left + m.width_mm,
               bottom = top + m.height_mm, arm = m.arm_mm, line = m.line_mm;
  std::vector<Box> boxes{{left, top, left + m.square_mm, top + m.square_mm},
                         {right - arm, top, right, top + line},
                         {right - line, top, right, top + arm},
                         {left, bottom - line, left + arm, bottom},
                         {left, bottom - arm, left + line, bottom}};
  if (m.four_corners) {
    boxes.push_back({right - arm, bottom - line, right, bottom});
    boxes.push_back({right - line, bottom - arm, right, bottom});
  }
  return boxes;
}

std::array<double, 2> within_marks_mm(std::array<double, 2> page_mm) {
  return {page_mm[0] - kInsetMm - kClearMm, page_mm[1] - kFarInsetMm - kClearMm};
}

std::array<double, 2> room_within_marks_mm(std::array<double, 2> page_mm) {
  const auto most = within_marks_mm(page_mm);
  return {std::max(0.0, most[0] - kBesideMarksMm), std::max(0.0, most[1] - kBesideMarksMm)};
}

Result<MarkLayout> marks_for(std::array<double, 2> page_mm) {
  MarkLayout marks;
  marks.left_mm = marks.top_mm = kInsetMm;
  marks.width_mm = page_mm[0] - 2 * kInsetMm;
  marks.height_mm = page_mm[1] - kInsetMm - kFarInsetMm;
  if (marks.width_mm >= kLeastMm && marks.height_mm >= kLeastMm) return marks;
  return fail(
      ErrorKind::Infeasible, "marks",
      fmt::format("a page of {:g} x {:g} mm is too small for registration marks; use at least {:g} "
                  "x {:g} mm",
                  page_mm[0], page_mm[1], kLeastMm + 2 * kInsetMm,
                  kLeastMm + kInsetMm + kFarInsetMm));
}

Result<void> check_marks(const MarkLayout& marks, const Toolpath& path) {
  if (auto valid = check_shape(marks); !valid) return valid;
  const double right = marks.left_mm + marks.width_mm;
  const double bottom = marks.top_mm + marks.height_mm;
  const std::vector<Box> boxes = mark_boxes(marks);
  for (std::size_t k = 0; k < path.strokes.size(); ++k) {
    for (const PagePoint& p : path.points_of(path.strokes[k])) {
      const std::string place = fmt::format("/strokes/{}", k);
      constexpr double kNoise = 1e-9;
      if (p.x < marks.left_mm - kNoise || p.x > right + kNoise || p.y < marks.top_mm - kNoise ||
          p.y > bottom + kNoise)
        return fail(ErrorKind::Infeasible, place,
                    fmt::format("({:.1f}, {:.1f}) mm lies outside the registration marks; keep all "
                                "lines between ({:g}, {:g}) and ({:g}, {:g}) mm",
                                p.x, p.y, marks.left_mm, marks.top_mm, right, bottom));
      const bool on_mark = std::any_of(boxes.begin(), boxes.end(), [&](const Box& box) {
        return p.x > box.x0 && p.x < box.x1 && p.y > box.y0 && p.y < box.y1;
      });
      if (on_mark)
        return fail(ErrorKind::Infeasible, place,
                    fmt::format("({:.1f}, {:.1f}) mm lies on a registration mark; move the drawing "
                                "with `at`",
                                p.x, p.y));
    }
  }
  return {};
}

std::string marks_svg(const MarkLayout& m, std::array<double, 2> page_mm,
                      const std::string& title) {
  std::string svg =
      svg_head(fmt::format("width=\"{0:g}mm\" height=\"{1:g}mm\" viewBox=\"0 0 {0:g} {1:g}\"",
                           page_mm[0], page_mm[1]),
               title) +
      "<g id=\"registration-marks\" fill=\"black\">\n";
  for (const Box& box : mark_boxes(m))
    svg += fmt::format("<rect x=\"{:g}\" y=\"{:g}\" width=\"{:g}\" height=\"{:g}\"/>\n", box.x0,
                       box.y0, box.width(), box.height());
  return svg + "</g>\n</svg>\n";
}

}  // namespace popcut
