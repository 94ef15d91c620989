// SPDX-License-Identifier: MIT
#include "core/drawing/sheet_frame.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace popcut {
namespace {

constexpr double kPixels = 600.0;       // the width at which pictures must be readable
constexpr double kLetterPixels = 11.0;  // the least size of letters there
constexpr double kLinePixels = 1.1;
constexpr double kLeastLetterMm = 2.0;  // small pictures are looked at in their own size

}  // namespace

SheetFrame sheet_frame(const Box& drawn, const std::array<double, 2>& sheet_mm, double beside_ems) {
  SheetFrame frame;
  Box sheet;
  sheet.add({0, 0});
  sheet.add({sheet_mm[0], sheet_mm[1]});
  const bool fills =
      drawn.empty() || drawn.width() > sheet_mm[0] / 2 || drawn.height() > sheet_mm[1] / 2;
  frame.whole = fills;
  frame.shown = fills ? sheet : drawn;
  if (!drawn.empty()) {  // a machine may be told to leave its sheet
    frame.shown.add({drawn.x0, drawn.y0});
    frame.shown.add({drawn.x1, drawn.y1});
  }
  const double size = std::max(frame.shown.width(), frame.shown.height());
  const double margin = std::max(2.0, 0.04 * size);
  frame.shown.add({frame.shown.x0 - margin, frame.shown.y0 - margin});
  frame.shown.add({frame.shown.x1 + margin, frame.shown.y1 + margin});
  // With words beside it, the picture is wider by as many letters.
  const double share = std::max(0.2, 1.0 - beside_ems * kLetterPixels / kPixels);
  frame.text_mm = std::max(kLeastLetterMm, frame.shown.width() * kLetterPixels / kPixels / share);
  frame.line_mm = frame.text_mm * kLinePixels / kLetterPixels;
  return frame;
}

std::string sheet_rect_svg(const SheetFrame& frame, const std::array<double, 2>& sheet_mm) {
  return fmt::format(
      "<rect id=\"sheet\" width=\"{:.3f}\" height=\"{:.3f}\" fill=\"#fbf9f2\" stroke=\"#b8b4a8\" "
      "stroke-width=\"{:.3f}\"/>\n",
      sheet_mm[0], sheet_mm[1], frame.line_mm);
}

std::string sheet_inset_svg(const SheetFrame& frame, const Box& drawn,
                            const std::array<double, 2>& sheet_mm, const PagePoint& corner,
                            double size_mm) {
  if (frame.whole || drawn.empty()) return {};
  const double scale = size_mm / std::max(sheet_mm[0], sheet_mm[1]);
  return fmt::format(
      "<g id=\"on-the-sheet\" stroke-width=\"{:.3f}\"><rect x=\"{:.3f}\" y=\"{:.3f}\" "
      "width=\"{:.3f}\" height=\"{:.3f}\" fill=\"#fbf9f2\" stroke=\"#b8b4a8\"/>"
      "<rect x=\"{:.3f}\" y=\"{:.3f}\" width=\"{:.3f}\" height=\"{:.3f}\" fill=\"#c9d6ea\" "
      "stroke=\"#5a76a8\"/></g>\n",
      frame.line_mm / 2, corner.x, corner.y, sheet_mm[0] * scale, sheet_mm[1] * scale,
      corner.x + drawn.x0 * scale, corner.y + drawn.y0 * scale, drawn.width() * scale,
      drawn.height() * scale);
}

std::string sheet_words(const Box& drawn, const std::array<double, 2>& sheet_mm) {
  if (drawn.empty()) return fmt::format("sheet {:.1f} x {:.1f} mm", sheet_mm[0], sheet_mm[1]);
  return fmt::format("{:.1f} x {:.1f} mm on a sheet of {:.1f} x {:.1f} mm", drawn.width(),
                     drawn.height(), sheet_mm[0], sheet_mm[1]);
}

double seen_line_mm(double page_width_mm, double page_height_mm) {
  return std::clamp(std::max(page_width_mm, page_height_mm) * kLinePixels / kPixels, 0.1, 0.6);
}

}  // namespace popcut
