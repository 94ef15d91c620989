// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "core/text/blanks.hpp"

namespace popcut {

/// A length as it is written in SVG or CSS.
struct SvgLength {
  enum class Unit : std::uint8_t {
    User,     ///< a bare number or px: user units
    Mm,       ///< mm cm in pt pc Q, in mm
    Percent,  ///< of a size of the viewport
    Em,       ///< em (ex is half of one), of the font size
  };
  double value{};
  Unit unit{Unit::User};
};

/// What lengths are measured by.
struct SvgMeasure {
  double user_mm{25.4 / 96};  ///< a user unit (a CSS pixel)
  double whole{};             ///< what 100 % are, in user units
  double font{16.0};          ///< font size in user units
};

/// A finite number and its unit (in either case), with nothing after it.
[[nodiscard]] std::optional<SvgLength> parse_svg_length(std::string_view text);

[[nodiscard]] double user_units(const SvgLength& length, const SvgMeasure& measure);

/// Whether two words are one, ASCII letters in either case.
[[nodiscard]] bool same_word(std::string_view a, std::string_view b);

}  // namespace popcut
