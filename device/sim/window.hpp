// SPDX-License-Identifier: MIT
#pragma once

#include <optional>

#include "core/drawing/linework.hpp"

namespace popcut {

[[nodiscard]] constexpr PagePoint along(PagePoint a, PagePoint b, double t) {
  return {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)};
}

/// The part of the page that a machine reaches, edges included.
struct Window {
  double left{}, top{}, right{}, bottom{};

  [[nodiscard]] constexpr PagePoint clamped(PagePoint p) const {
    const auto between = [](double v, double lo, double hi) {
      return v < lo ? lo : v > hi ? hi : v;
    };
    return {between(p.x, left, right), between(p.y, top, bottom)};
  }
};

/// The part of a segment inside a window: 0 is the segment's start, 1 its end.
struct Inside {
  double from{0};
  double to{1};
};

/// The part of the segment `a b` inside `window` (Liang and Barsky 1984); none if the segment lies
/// outside or only touches the window.
[[nodiscard]] std::optional<Inside> clip(const Window& window, PagePoint a, PagePoint b);

}  // namespace popcut
