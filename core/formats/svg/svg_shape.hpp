// SPDX-License-Identifier: MIT
#pragma once

#include <string_view>

#include <pugixml.hpp>

#include "core/formats/svg/syntax/svg_path.hpp"
#include "core/formats/svg/syntax/svg_units.hpp"

namespace popcut {

/// The viewport to which percentages refer, in user units.
struct SvgFrame {
  double width{}, height{};
};

/// How a shape is outlined.
struct SvgOutlining {
  SvgFrame frame;
  double user_mm{25.4 / 96};
  SvgFont font;
  double tolerance{0.02};  ///< user units
  std::size_t most_points{1'000'000};
  bool closes{false};  ///< close open lines, as a fill does
};

/// Whether `name` is a basic shape or a path.
[[nodiscard]] bool is_svg_shape(std::string_view name);

/// Appends the outline of `node`, an element called `name`, to `lines`. A shape without size has
/// none.
///
/// @retval Malformed   path data, points or a length that cannot be read
/// @retval OutOfRange  more than `most_points` points
[[nodiscard]] Result<void> outline_of(const pugi::xml_node& node, std::string_view name,
                                      std::string_view d, const SvgOutlining& how, SvgLines& lines);

/// An attribute as a length in user units; `measure.whole` is 100 %. Returns `otherwise` if the
/// attribute is missing or "auto".
///
/// @retval Malformed  it is not a length
[[nodiscard]] Result<double> svg_attribute(const pugi::xml_node& node, const char* name,
                                           double otherwise, const SvgMeasure& measure);

/// The length that is 100 % for lengths that are neither widths nor heights (SVG 2, section 8.9).
[[nodiscard]] double frame_diagonal(const SvgFrame& frame);

}  // namespace popcut
