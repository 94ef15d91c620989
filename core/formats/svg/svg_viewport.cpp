// SPDX-License-Identifier: MIT
#include "core/formats/svg/svg_viewport.hpp"

#include <algorithm>

#include "core/formats/svg/syntax/svg_scan.hpp"
#include "core/formats/svg/syntax/svg_units.hpp"

namespace popcut {
namespace {

// The fraction of the spare room that lies before the drawing: Min, Mid or Max.
std::optional<double> share(std::string_view word) {
  if (word == "Min") return 0.0;
  if (word == "Mid") return 0.5;
  if (word == "Max") return 1.0;
  return std::nullopt;
}

std::string_view next_word(std::string_view& text) {
  text = trimmed(text);
  const std::size_t end = std::min(text.find_first_of(" \t\r\n\f"), text.size());
  const std::string_view word = text.substr(0, end);
  text.remove_prefix(end);
  return word;
}

}  // namespace

std::optional<std::array<double, 4>> parse_svg_view_box(std::string_view text) {
  SvgScan scan(text);
  std::array<double, 4> box{};
  for (double& value : box)
    if (!scan.number(value)) return std::nullopt;
  if (!scan.at_end()) return std::nullopt;
  return box;
}

SvgTransform fit_svg_view_box(const std::array<double, 4>& box, double width, double height,
                              std::string_view aspect) {
  std::string_view align = next_word(aspect);
  if (align == "defer") align = next_word(aspect);
  double sx = width / box[2], sy = height / box[3];
  double before_x = 0.5, before_y = 0.5;
  if (align != "none") {
    if (align.size() == 8 && align[0] == 'x' && align[4] == 'Y') {
      before_x = share(align.substr(1, 3)).value_or(0.5);
      before_y = share(align.substr(5, 3)).value_or(0.5);
    }
    sx = sy = next_word(aspect) == "slice" ? std::max(sx, sy) : std::min(sx, sy);
  }
  return {sx,
          0,
          0,
          sy,
          (width - sx * box[2]) * before_x - sx * box[0],
          (height - sy * box[3]) * before_y - sy * box[1]};
}

}  // namespace popcut
