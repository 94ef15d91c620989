// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <pugixml.hpp>

#include "core/formats/svg_reader.hpp"

namespace popcut {

/// What an element inherits and sets of its looks and its meaning.
struct SvgStyle {
  std::string stroke{"none"};
  std::string fill{"black"};
  bool hidden{false};
  bool display_none{false};
  std::vector<double> dashes;  ///< user units, even count; empty: solid
  double dash_offset{};
  std::string assignment;  ///< data-assignment of it or of the nearest ancestor that has one
  std::string layer;       ///< label of the nearest Inkscape layer whose label says a meaning
};

/// The style of `node`, whose parent has `inherited`. Presentation attributes, then `style`.
[[nodiscard]] SvgStyle style_of(const pugi::xml_node& node, const SvgStyle& inherited);

/// What a line of this style is for; none: it is not cut.
[[nodiscard]] std::optional<Operation> operation_of(const SvgStyle& style, SvgProfile profile);

/// "#rrggbb" of a colour, in lower case; as it stands if it is not understood.
[[nodiscard]] std::string plain_colour(std::string_view colour);

/// The parts of `line` that are drawn with `dashes`; both in user units.
[[nodiscard]] std::vector<std::vector<PagePoint>> dashed_by_style(
    const std::vector<PagePoint>& line, const SvgStyle& style, std::size_t most_points);

}  // namespace popcut
