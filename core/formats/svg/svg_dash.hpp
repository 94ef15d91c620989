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

inline constexpr std::size_t kMaxDashNumbers = 1000;  ///< limit of one stroke-dasharray

/// Parses a stroke-dasharray: lengths or percentages, separated by commas or spaces. An empty list
/// means a solid line: `none`, or an invalid list (a negative or unreadable number). No value: more
/// than `kMaxDashNumbers` numbers.
[[nodiscard]] std::optional<std::vector<SvgLength>> parse_svg_dashes(std::string_view text);

/// Alternating lengths of dashes and gaps, an even number, in user units. Empty: solid.
struct SvgDashes {
  std::vector<double> lengths;
  double offset{};  ///< where in the dash pattern a line begins
};

/// Resolves a dash list by SVG 2, section 13.5.6: an odd list is repeated, a sum of zero is solid.
[[nodiscard]] SvgDashes svg_dashes(std::span<const SvgLength> list, const SvgLength& offset,
                                   const SvgMeasure& measure);

/// Appends the parts of `line` that `dashes` draw. Leaves out dashes without length (dots). Each
/// dash and each gap uses up one of `steps`; returns false if there are not enough steps.
[[nodiscard]] bool cut_into_dashes(std::span<const PagePoint> line, const SvgDashes& dashes,
                                   std::size_t& steps, SvgLines& out);

}  // namespace popcut
