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

/// The common stretch of two segments; none if they only cross or touch. Each end of `b` may be off
/// by `reach` along each axis, so the distance from `a` is at most reach (|cos| + |sin|) of the
/// direction of `a`.
[[nodiscard]] std::optional<Along> run_along(const Segment& a, const Segment& b, double reach);

/// Points, searchable by place.
class VertexGrid {
 public:
  VertexGrid(std::vector<PagePoint> points, double reach);
  /// True if one of them is within `reach` of `p` along each axis.
  [[nodiscard]] bool near(PagePoint p) const;

 private:
  [[nodiscard]] double column(double x) const;
  std::vector<PagePoint> points_;  ///< by column, then y
  double reach_;
};

}  // namespace popcut
