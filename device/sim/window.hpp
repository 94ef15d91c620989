// SPDX-License-Identifier: MIT
#pragma once

#include <optional>

#include "core/drawing/linework.hpp"

namespace popcut {

[[nodiscard]] constexpr PagePoint along(PagePoint a, PagePoint b, double t) {
  return {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)};
}

/// The part of the page that a machine reaches; its edges belong to it.
struct Window {
  double left{}, top{}, right{}, bottom{};

  [[nodiscard]] constexpr PagePoint clamped(PagePoint p) const {
    const auto between = [](double v, double lo, double hi) {
      return v < lo ? lo : v > hi ? hi : v;
    };
    return {between(p.x, left, right), between(p.y, top, bottom)};
  }
};

/// From where to where a segment runs inside a window: 0 is its start, 1 its end.
struct Inside {
  double from{0};
  double to{1};
};

/// The part of `a b` inside `window` (Liang and Barsky 1984); none if it does not meet it. A
/// segment that only touches the window from outside has no inside.
[[nodiscard]] std::optional<Inside> clip(const Window& window, PagePoint a, PagePoint b);

}  // namespace popcut
