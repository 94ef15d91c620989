// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <vector>

#include "core/geometry/overlap.hpp"
#include "device/compare/fold_check.hpp"

namespace popcut {

/// Where `b` runs along `a`, as stretches of both.
struct Along {
  Stretch a, b;
};

/// The common stretch of two segments; none if they only cross or touch. The ends of `b` lie within
/// `reach` along each axis of where they should, so beside `a` it is at most reach (|cos| + |sin|)
/// of the direction of `a`.
[[nodiscard]] std::optional<Along> run_along(const Segment& a, const Segment& b, double reach);

/// Points that can be asked for by place.
class VertexGrid {
 public:
  VertexGrid(std::vector<PagePoint> points, double reach);
  /// Is one of them within `reach` of `p` along each axis?
  [[nodiscard]] bool near(PagePoint p) const;

 private:
  [[nodiscard]] double column(double x) const;
  std::vector<PagePoint> points_;  ///< by column, then y
  double reach_;
};

}  // namespace popcut
