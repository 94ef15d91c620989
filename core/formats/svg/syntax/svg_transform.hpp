// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string_view>

#include "core/drawing/toolpath.hpp"

namespace popcut {

/// (x, y) -> (a x + c y + e, b x + d y + f), as SVG's matrix().
struct SvgTransform {
  double a{1}, b{0}, c{0}, d{1}, e{0}, f{0};
  [[nodiscard]] PagePoint operator()(const PagePoint& p) const {
    return {a * p.x + c * p.y + e, b * p.x + d * p.y + f};
  }
  /// First `inner`, then this.
  [[nodiscard]] SvgTransform operator*(const SvgTransform& inner) const;
  /// The way back; none where areas vanish.
  [[nodiscard]] std::optional<SvgTransform> inverse() const;
  /// The most that any length grows.
  [[nodiscard]] double largest_scale() const;
};

/// A `transform` attribute: matrix, translate, scale, rotate, skewX, skewY, one after the other, or
/// none. Numbers may have deg or px after them.
[[nodiscard]] std::optional<SvgTransform> parse_svg_transform(std::string_view text);

}  // namespace popcut
