// SPDX-License-Identifier: MIT
#pragma once

#include <iterator>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "core/plot/plot.hpp"

namespace popcut::plot {

/// The rectangle of the axes within the document, px, y down, and the way from values to it.
struct Frame {
  double left{}, top{}, width{}, height{};
  Axis x, y;

  [[nodiscard]] double px(double value) const;
  [[nodiscard]] double py(double value) const;
};

/// Appends formatted text.
template <typename... Values>
void put(std::string& svg, fmt::format_string<Values...> text, Values&&... values) {
  fmt::format_to(std::back_inserter(svg), text, std::forward<Values>(values)...);
}
/// `text` of an element, escaped, at (x, y); `anchor` is start, middle or end.
void put_text(std::string& svg, double x, double y, std::string_view text, std::string_view anchor,
              int size = 13, bool halo = false);
void put_line(std::string& svg, double x0, double y0, double x1, double y1, std::string_view colour,
              double width);

/// The bands, contours and colour bar of `map`.
void put_map(std::string& svg, const Map& map, const Frame& frame);
/// A panel of surfaces in the box from (left, top).
void put_surfaces(std::string& svg, const IsoPanel& panel, double left, double top);

}  // namespace popcut::plot
