// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "core/compare/view.hpp"

namespace popcut::likeness {

/// Which pixels triangles cover, row by row.
///
/// A pixel is covered if its middle lies in the triangle. Corners are laid on a grid of 4096 a
/// pixel and edges are decided in whole numbers, so that a middle on a common edge of two triangles
/// belongs to exactly one of them (the top-left rule: Pineda, A Parallel Algorithm for Polygon
/// Rasterization, 1988). So each ray through a closed surface enters it as often as it leaves it.
class Raster {
 public:
  explicit Raster(const Frame& frame);

  /// Calls `span(row, first, last, depth, slope, low, high, side)` for each row of each triangle:
  /// the pixels from `first` to `last`, the depth at `first` and its change a pixel, the triangle's
  /// least and largest depth (slivers are extrapolated, so cut to them), and +1 where the
  /// triangle's outside (counter-clockwise) is seen, else -1. Depths count from the frame's centre.
  template <typename Span>
  void each_span(Triangles triangles, Span&& span) const;

 private:
  struct Corner {
    double x{}, y{}, t{};  ///< in pixels, and depth in mm
  };
  struct Point {
    std::int64_t x{}, y{};
  };
  static constexpr std::int64_t kGrid = 4096;  ///< a pixel
  static constexpr int kGuard = 4;             ///< images around the middle; what is beyond is cut

  static constexpr double kReach = 0.501;  ///< half a pixel, and more than the grid moves a corner
  /// The number of the pixel that a place lies in, plus a constant.
  static int cell(double at) { return static_cast<int>(at + 65536.0); }

  [[nodiscard]] Corner seen(const float* p) const;
  /// Cuts a triangle to three images around the frame: at most seven corners.
  [[nodiscard]] static int clipped(std::array<Corner, 8>& polygon, double low, double high);
  template <typename Span>
  void triangle(Corner a, Corner b, Corner c, Span&& span) const;

  std::array<double, 4> right_{}, up_{}, toward_{};  ///< factors of x, v, z and 1
  int pixels_;
};

template <typename Span>
void Raster::each_span(Triangles triangles, Span&& span) const {
  const double size = pixels_, low = -kGuard * size, high = (kGuard + 1) * size;
  for (std::size_t k = 0; k + 8 < triangles.size(); k += 9) {
    const Corner a = seen(&triangles[k]), b = seen(&triangles[k + 3]), c = seen(&triangles[k + 6]);
    const double x0 = std::min({a.x, b.x, c.x}), x1 = std::max({a.x, b.x, c.x});
    const double y0 = std::min({a.y, b.y, c.y}), y1 = std::max({a.y, b.y, c.y});
    if (!(x1 >= 0 && x0 <= size && y1 >= 0 && y0 <= size)) continue;
    if (x0 >= low && x1 <= high && y0 >= low && y1 <= high) {
      // Most triangles of a fine mesh lie between the middles of pixels.
      if (cell(x0 - kReach) < cell(x1 - 1.0 + kReach) &&
          cell(y0 - kReach) < cell(y1 - 1.0 + kReach))
        triangle(a, b, c, span);
      continue;
    }
    std::array<Corner, 8> polygon{a, b, c};
    const int count = clipped(polygon, -size, 2 * size);
    for (int n = 2; n < count; ++n)
      triangle(polygon[0], polygon[static_cast<std::size_t>(n - 1)],
               polygon[static_cast<std::size_t>(n)], span);
  }
}

template <typename Span>
void Raster::triangle(Corner a, Corner b, Corner c, Span&& span) const {
  const auto on_grid = [](const Corner& p) {
    return Point{std::llrint(p.x * static_cast<double>(kGrid)),
                 std::llrint(p.y * static_cast<double>(kGrid))};
  };
  Point p = on_grid(a), q = on_grid(b), r = on_grid(c);
  std::int64_t twice = (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x);
  if (twice == 0) return;
  const int side = twice > 0 ? 1 : -1;
  if (twice < 0) std::swap(q, r), std::swap(b, c), twice = -twice;
  const auto [left, right] = std::minmax({p.x, q.x, r.x});
  const auto [bottom, top] = std::minmax({p.y, q.y, r.y});
  // Pixels whose middles, (i + 1/2) kGrid, lie in the box.
  constexpr std::int64_t kHalf = kGrid / 2;
  const auto first_of = [](std::int64_t v) { return (v - kHalf + kGrid - 1) >> 12; };
  const auto last_of = [](std::int64_t v) { return (v - kHalf) >> 12; };
  static_assert(kGrid == 1 << 12);
  const auto x_first = std::max<std::int64_t>(0, first_of(left));
  const auto x_last = std::min<std::int64_t>(pixels_ - 1, last_of(right));
  const auto y_first = std::max<std::int64_t>(0, first_of(bottom));
  const auto y_last = std::min<std::int64_t>(pixels_ - 1, last_of(top));
  if (x_first > x_last || y_first > y_last) return;

  const auto area = static_cast<double>(twice);
  const auto ux = static_cast<double>(q.x - p.x), uy = static_cast<double>(q.y - p.y);
  const auto vx = static_cast<double>(r.x - p.x), vy = static_cast<double>(r.y - p.y);
  const auto grid = static_cast<double>(kGrid);
  const double slope = ((b.t - a.t) * vy - (c.t - a.t) * uy) / area * grid;  // a pixel
  const double rise = ((c.t - a.t) * ux - (b.t - a.t) * vx) / area * grid;
  const auto low = static_cast<float>(std::min({a.t, b.t, c.t}));
  const auto high = static_cast<float>(std::max({a.t, b.t, c.t}));

  // Edge k from p to q: inside where across x + along y + offset >= 0 at the pixel (x, y).
  std::array<std::int64_t, 3> across{}, along{}, offset{};
  const std::array<Point, 4> round{p, q, r, p};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::int64_t dx = round[k + 1].x - round[k].x, dy = round[k + 1].y - round[k].y;
    const bool owns_its_line = dy < 0 || (dy == 0 && dx < 0);
    offset[k] = dx * (kHalf - round[k].y) - dy * (kHalf - round[k].x) - (owns_its_line ? 0 : 1);
    across[k] = -dy * kGrid, along[k] = dx * kGrid;
  }
  constexpr std::int64_t kNarrow = 8;
  const bool narrow = x_last - x_first < kNarrow;
  for (std::int64_t y = y_first; y <= y_last; ++y) {
    std::int64_t from = x_first, to = x_last;
    if (narrow) {
      const std::int64_t e0 = offset[0] + along[0] * y, e1 = offset[1] + along[1] * y,
                         e2 = offset[2] + along[2] * y;
      const auto inside = [&](std::int64_t x) {
        return ((e0 + across[0] * x) | (e1 + across[1] * x) | (e2 + across[2] * x)) >= 0;
      };
      while (from <= to && !inside(from)) ++from;
      while (to > from && !inside(to)) --to;
    } else {
      for (std::size_t k = 0; k < 3; ++k) {
        const std::int64_t e = offset[k] + along[k] * y, a_k = across[k];
        if (a_k == 0) {
          if (e < 0) to = from - 1;
        } else if (a_k > 0) {  // x >= -e / a, rounded up
          const std::int64_t n = -e;
          from = std::max(from, n >= 0 ? (n + a_k - 1) / a_k : -((-n) / a_k));
        } else {  // x <= e / -a, rounded down
          const std::int64_t m = -a_k;
          to = std::min(to, e >= 0 ? e / m : -((-e + m - 1) / m));
        }
      }
    }
    if (from > to) continue;
    const double dx = static_cast<double>(from * kGrid + kHalf - p.x) / grid;
    const double dy = static_cast<double>(y * kGrid + kHalf - p.y) / grid;
    span(static_cast<std::size_t>(y), static_cast<std::size_t>(from), static_cast<std::size_t>(to),
         static_cast<float>(a.t + slope * dx + rise * dy), static_cast<float>(slope), low, high,
         side);
  }
}

}  // namespace popcut::likeness
