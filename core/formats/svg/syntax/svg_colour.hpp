// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace popcut {

/// What a stroke or a fill is painted with.
struct SvgPaint {
  enum class Kind : std::uint8_t {
    None,     ///< not painted
    Colour,   ///< `rgb`
    Current,  ///< the colour of `color`
    Server,   ///< a gradient or pattern; `rgb` is its fallback colour
  };
  Kind kind{Kind::None};
  std::uint32_t rgb{};  ///< 0xRRGGBB
  friend bool operator==(const SvgPaint&, const SvgPaint&) = default;
};

/// Parses a paint: none, a CSS colour (names, #hex, rgb(), hsl(), currentColor), or url(#id) with
/// or without a fallback colour. A fully transparent paint is none. No value: not a paint.
[[nodiscard]] std::optional<SvgPaint> parse_svg_paint(std::string_view text);

/// "#rrggbb".
[[nodiscard]] std::string colour_text(std::uint32_t rgb);

}  // namespace popcut
