// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/formats/svg/syntax/svg_path.hpp"
#include "core/formats/svg/syntax/svg_units.hpp"

namespace popcut {

inline constexpr std::size_t kMaxDashNumbers = 1000;  ///< of one stroke-dasharray

/// A stroke-dasharray: lengths or percentages, with commas or blanks between them. Empty: solid,
/// which `none` is, and what SVG does not allow (a negative or unreadable number). None: there are
/// more than `kMaxDashNumbers`.
[[nodiscard]] std::optional<std::vector<SvgLength>> parse_svg_dashes(std::string_view text);

/// Dashes and gaps in turn, an even number of them, in user units. Empty: solid.
struct SvgDashes {
  std::vector<double> lengths;
  double offset{};  ///< where in the pattern a line begins
};

/// SVG 2, section 13.5.6: an odd list is taken twice, a sum of zero is solid.
[[nodiscard]] SvgDashes svg_dashes(std::span<const SvgLength> list, const SvgLength& offset,
                                   const SvgMeasure& measure);

/// Adds the parts of `line` that `dashes` draw to `out`. Dashes without length (dots) are left
/// out. Every dash and every gap takes one of `steps`; false when they do not suffice.
[[nodiscard]] bool cut_into_dashes(std::span<const PagePoint> line, const SvgDashes& dashes,
                                   std::size_t& steps, SvgLines& out);

}  // namespace popcut
