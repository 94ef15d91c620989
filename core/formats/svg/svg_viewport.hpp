// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "core/formats/svg/syntax/svg_transform.hpp"

namespace popcut {

/// A viewBox: least x, least y, width and height; four finite numbers.
[[nodiscard]] std::optional<std::array<double, 4>> parse_svg_view_box(std::string_view text);

/// The transform by which a viewBox of positive size fills a frame at the origin, by
/// preserveAspectRatio (xMidYMid meet if `aspect` is empty or unreadable).
[[nodiscard]] SvgTransform fit_svg_view_box(const std::array<double, 4>& box, double width,
                                            double height, std::string_view aspect);

}  // namespace popcut
