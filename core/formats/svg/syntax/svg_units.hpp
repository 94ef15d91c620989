// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "core/text/words.hpp"

namespace popcut {

/// A length as it is written in SVG or CSS.
struct SvgLength {
  enum class Unit : std::uint8_t {
    User,     ///< a bare number or px: user units
    Mm,       ///< mm cm in pt pc Q, in mm
    Percent,  ///< percentage of a size of the viewport
    Em,       ///< em, relative to the font size (ex is half an em)
  };
  double value{};
  Unit unit{Unit::User};
};

/// What relative lengths refer to.
struct SvgMeasure {
  double user_mm{25.4 / 96};  ///< size of a user unit (a CSS pixel)
  double whole{};             ///< what 100 % is, in user units
  double font{16.0};          ///< font size in user units
};

/// Parses a finite number and its unit (in any case), with nothing after it.
[[nodiscard]] std::optional<SvgLength> parse_svg_length(std::string_view text);

/// `length` in user units.
[[nodiscard]] double user_units(const SvgLength& length, const SvgMeasure& measure);

}  // namespace popcut
