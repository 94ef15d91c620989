// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/toolpath.hpp"

namespace popcut {

/// Points in a uniform grid of about one point a cell: nearest neighbours in O(1) on average for
/// points that are spread evenly. Ties go to the lower index.
class PointGrid {
 public:
  explicit PointGrid(std::span<const PagePoint> points);

  /// The up to `k` points nearest to `p` for which `take(index)` holds, nearest first.
  template <typename Take>
  void nearest(const PagePoint& p, std::size_t k, Take&& take,
               std::vector<std::uint32_t>& out) const;

 private:
  [[nodiscard]] std::int64_t column(double x) const;
  [[nodiscard]] std::int64_t row(double y) const;
  template <typename Visit>
  void visit_ring(std::int64_t cx, std::int64_t cy, std::int64_t ring, Visit&& visit) const;

  std::vector<PagePoint> points_;
  double cell_{1.0};
  double x0_{}, y0_{};
  std::int64_t columns_{1}, rows_{1};
  std::vector<std::uint32_t> first_;
  std::vector<std::uint32_t> items_;
};

template <typename Visit>
void PointGrid::visit_ring(std::int64_t cx, std::int64_t cy, std::int64_t ring,
                           Visit&& visit) const {
  const auto row_of = [&](std::int64_t y, std::int64_t step) {
    if (y < 0 || y >= rows_) return;
    for (std::int64_t x = cx - ring; x <= cx + ring; x += step)
      if (x >= 0 && x < columns_) visit(static_cast<std::size_t>(y * columns_ + x));
  };
  row_of(cy - ring, 1);
  if (ring == 0) return;
  for (std::int64_t y = cy - ring + 1; y < cy + ring; ++y) row_of(y, 2 * ring);
  row_of(cy + ring, 1);
}

template <typename Take>
void PointGrid::nearest(const PagePoint& p, std::size_t k, Take&& take,
                        std::vector<std::uint32_t>& out) const {
  out.clear();
  const auto squared = [&](std::uint32_t i) {
    const double dx = points_[i].x - p.x, dy = points_[i].y - p.y;
    return dx * dx + dy * dy;
  };
  const auto perfect = [&] { return out.size() == k && squared(out.back()) == 0.0; };
  const std::int64_t cx = column(p.x), cy = row(p.y);
  const std::int64_t last = columns_ > rows_ ? columns_ : rows_;
  for (std::int64_t ring = 0; ring <= last; ++ring) {
    visit_ring(cx, cy, ring, [&](std::size_t cell) {
      for (std::uint32_t q = first_[cell]; q < first_[cell + 1] && !perfect(); ++q) {
        const std::uint32_t i = items_[q];
        if (!take(i)) continue;
        const double d = squared(i);
        std::size_t at = out.size();
        while (at > 0 &&
               (squared(out[at - 1]) > d || (squared(out[at - 1]) == d && out[at - 1] > i)))
          --at;
        if (at == k) continue;
        if (out.size() == k) out.pop_back();
        out.insert(out.begin() + static_cast<std::ptrdiff_t>(at), i);
      }
    });
    // All points of the rings further out are at least `ring` cells away, less the place in the
    // cell.
    const double reach = static_cast<double>(ring) * cell_;
    if (out.size() == k && squared(out.back()) <= reach * reach) return;
  }
}

}  // namespace popcut
