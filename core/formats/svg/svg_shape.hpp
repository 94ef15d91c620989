// SPDX-License-Identifier: MIT
#pragma once

#include <string_view>

#include <pugixml.hpp>

#include "core/formats/svg/syntax/svg_path.hpp"
#include "core/formats/svg/syntax/svg_units.hpp"

namespace popcut {

/// The viewport that percentages are of, in user units.
struct SvgFrame {
  double width{}, height{};
};

/// How a shape is outlined.
struct SvgOutlining {
  SvgFrame frame;
  double user_mm{25.4 / 96};
  double font{16.0};
  double tolerance{0.02};  ///< user units
  std::size_t most_points{1'000'000};
  bool closes{false};  ///< open lines are closed, as a fill does
};

/// Whether `name` is a basic shape or a path.
[[nodiscard]] bool is_svg_shape(std::string_view name);

/// Adds the outline of `node`, an element `name`, to `lines`. A shape of no size has none.
///
/// @retval Malformed   path data, points or a length that cannot be read
/// @retval OutOfRange  more than `most_points` points
[[nodiscard]] Result<void> outline_of(const pugi::xml_node& node, std::string_view name,
                                      std::string_view d, const SvgOutlining& how, SvgLines& lines);

/// An attribute as a length in user units; `whole` is what 100 % are. `otherwise` where it is not
/// there or "auto".
///
/// @retval Malformed  it is no length
[[nodiscard]] Result<double> svg_attribute(const pugi::xml_node& node, const char* name,
                                           double otherwise, const SvgMeasure& measure);

/// What 100 % of a length that is neither width nor height are (SVG 2, section 8.9).
[[nodiscard]] double frame_diagonal(const SvgFrame& frame);

}  // namespace popcut
