// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/drawing/toolpath.hpp"
#include "core/machines/machine.hpp"
#include "core/result.hpp"

namespace popcut {

class LineIndex;

/// An interval along a seam, in mm.
struct SeamStretch {
  double from{}, to{};
  std::uint32_t first_tab{}, tabs{};  ///< indices into the layout's tabs
};

/// A tab in drawing mm: first its root, then the edge that lies under the other piece.
struct Tab {
  std::array<PagePoint, 4> corners{};  ///< a triangle repeats its tip
  std::uint32_t run{};                 ///< the seam run that it stands on
  std::uint32_t on{}, under{};  ///< the piece that it belongs to, and the piece it is glued to
  double depth_mm{};
};

/// A line parallel to an axis: at x = `at` (vertical), or at y = `at`.
struct AxisLine {
  bool vertical{};
  double at{};
  /// The point at distance `t` along the line and `n` beside it.
  [[nodiscard]] PagePoint point(double t, double n) const {
    return vertical ? PagePoint{at + n, t} : PagePoint{t, at + n};
  }
};

/// Fits tabs on `side` (+1: towards larger coordinates) of a stretch, each clear of all lines and
/// of the `taken` tabs. Appends all tabs of the stretch to `out`, or none.
///
/// A root of length r carries a trapezoid of depth d if r >= 2 d / tan(side) + 1 mm. A shorter root
/// carries a shallower trapezoid or a triangle of depth r tan(side) / 2, but never less than the
/// least depth.
class TabFitter {
 public:
  TabFitter(LineIndex& lines, const TabShape& shape) : lines_(lines), shape_(shape) {}
  /// The least depth of the stretch's tabs in mm; 0 if one of them has no room.
  [[nodiscard]] double fit(const AxisLine& line, const SeamStretch& stretch, int side,
                           std::vector<Tab>& out);

 private:
  [[nodiscard]] bool fit_one(const AxisLine& line, double from, double to, int side, Tab& tab);
  LineIndex& lines_;
  TabShape shape_;
};

/// Whether two tabs come closer than `clearance_mm` (convex polygons, separating axes).
[[nodiscard]] bool tabs_meet(const Tab& a, const Tab& b, double clearance_mm);

}  // namespace popcut
