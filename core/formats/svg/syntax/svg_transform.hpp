// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "core/drawing/toolpath.hpp"

namespace popcut {

/// (x, y) -> (a x + c y + e, b x + d y + f), like SVG's matrix().
struct SvgTransform {
  double a{1}, b{0}, c{0}, d{1}, e{0}, f{0};
  [[nodiscard]] PagePoint operator()(const PagePoint& p) const {
    return {a * p.x + c * p.y + e, b * p.x + d * p.y + f};
  }
  /// Applies `inner` first, then this transform.
  [[nodiscard]] SvgTransform operator*(const SvgTransform& inner) const;
  /// The inverse transform; none if areas become zero.
  [[nodiscard]] std::optional<SvgTransform> inverse() const;
  /// The largest factor by which any length grows.
  [[nodiscard]] double largest_scale() const;
};

/// Parses a `transform` attribute: a sequence of matrix, translate, scale, rotate, skewX and skewY,
/// or none. Numbers may be followed by deg or px.
[[nodiscard]] std::optional<SvgTransform> parse_svg_transform(std::string_view text);

/// A viewBox: least x, least y, width and height; four finite numbers.
[[nodiscard]] std::optional<std::array<double, 4>> parse_svg_view_box(std::string_view text);

/// The transform by which a viewBox of positive size fills a frame at the origin, by
/// preserveAspectRatio (xMidYMid meet if `aspect` is empty or unreadable).
[[nodiscard]] SvgTransform fit_svg_view_box(const std::array<double, 4>& box, double width,
                                            double height, std::string_view aspect);

}  // namespace popcut
