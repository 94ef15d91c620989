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
    Rem,      ///< rem, relative to the font size of the root
  };
  double value{};
  Unit unit{Unit::User};
};

/// Font sizes in user units, of an element and of the root.
struct SvgFont {
  double own{16.0}, root{16.0};
};

/// What relative lengths refer to.
struct SvgMeasure {
  double user_mm{25.4 / 96};  ///< size of a user unit (a CSS pixel)
  double whole{};             ///< what 100 % is, in user units
  SvgFont font;
};

/// Parses a finite number and its unit (in any case), with nothing after it.
[[nodiscard]] std::optional<SvgLength> parse_svg_length(std::string_view text);

/// A font-size as CSS writes it: a length, or a word such as large or smaller, in em or user units.
[[nodiscard]] std::optional<SvgLength> parse_svg_font_size(std::string_view text);

/// The font-size in the shorthand `font`: "bold 12px/1.5 serif".
[[nodiscard]] std::optional<SvgLength> font_size_of_shorthand(std::string_view text);

/// `length` in user units.
[[nodiscard]] double user_units(const SvgLength& length, const SvgMeasure& measure);

}  // namespace popcut
