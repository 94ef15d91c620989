// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/machines/tab_shape.hpp"
#include "core/result.hpp"
#include "core/drawing/toolpath.hpp"

namespace popcut {

class LineIndex;

/// An interval along a seam, mm.
struct SeamStretch {
  double from{}, to{};
  std::uint32_t first_tab{}, tabs{};  ///< of the layout's tabs
};

/// A tab in drawing mm: root first, then the edge that lies under the other piece.
struct Tab {
  std::array<PagePoint, 4> corners{};  ///< a triangle has its tip twice
  std::uint32_t run{};                 ///< the seam's run it stands on
  std::uint32_t on{}, under{};         ///< the piece it is part of, the one it is glued to
  double depth_mm{};
};

/// A line parallel to an axis: at x = `at` (vertical), or at y = `at`.
struct AxisLine {
  bool vertical{};
  double at{};
  /// The point `t` along it and `n` beside it.
  [[nodiscard]] PagePoint point(double t, double n) const {
    return vertical ? PagePoint{at + n, t} : PagePoint{t, at + n};
  }
};

/// Tabs on `side` (+1: towards larger coordinates) of the stretch, each clear of every line and of
/// the `taken` ones. Appends to `out`, all or none.
///
/// A root of length r takes a trapezoid of depth d where r >= 2 d / tan(side) + 1 mm, a shallower
/// one, or a triangle of depth r tan(side) / 2, but at least the least depth.
class TabFitter {
 public:
  TabFitter(LineIndex& lines, const TabShape& shape) : lines_(lines), shape_(shape) {}
  /// Least depth over the stretch's tabs; 0 where one finds no room.
  [[nodiscard]] double fit(const AxisLine& line, const SeamStretch& stretch, int side,
                           std::vector<Tab>& out);

 private:
  [[nodiscard]] bool fit_one(const AxisLine& line, double from, double to, int side, Tab& tab);
  LineIndex& lines_;
  TabShape shape_;
};

/// Whether two tabs come nearer than `clearance_mm` (convex polygons, separating axes).
[[nodiscard]] bool tabs_meet(const Tab& a, const Tab& b, double clearance_mm);

}  // namespace popcut
