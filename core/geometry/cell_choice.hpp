// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/geometry/cell_walk.hpp"
#include "core/geometry/page_point.hpp"

namespace popcut {

/// How many pairs of `count` segments share a cell of `cell_mm` and nearly a direction: the work of
/// looking at each segment's neighbours. By a hash of cells, so a little too many.
template <typename SegmentAt>
[[nodiscard]] double neighbour_pairs(std::size_t count, SegmentAt segment_at, double cell_mm) {
  std::vector<std::uint32_t> held(std::bit_ceil(2 * count + 16), 0);
  for (std::size_t k = 0; k < count; ++k) {
    const Segment s = segment_at(k);
    double dx = s.b.x - s.a.x, dy = s.b.y - s.a.y;
    if (dy < 0) dx = -dx, dy = -dy;
    const std::uint64_t direction = (dx >= 0 ? 0U : 2U) + (dy > std::abs(dx) ? 1U : 0U);
    walk_cells(s, cell_mm, 0.0, [&](std::int64_t x, std::int64_t y) {
      std::uint64_t h =
          static_cast<std::uint64_t>(x) * 0x9E3779B97F4A7C15ULL ^
          (static_cast<std::uint64_t>(y) + direction * 0x51ED27ULL) * 0xC2B2AE3D27D4EB4FULL;
      h = (h ^ (h >> 29)) * 0xBF58476D1CE4E5B9ULL;
      ++held[(h ^ (h >> 32)) & (held.size() - 1)];
      return true;
    });
  }
  double pairs = 0;
  for (const std::uint32_t n : held) pairs += static_cast<double>(n) * n;
  return pairs;
}

/// A cell size for an index of segments: `coarse_mm`, which suits lines that keep their distance,
/// or a smaller one where many lie side by side (rings 0.02 mm apart), as long as that saves work.
template <typename SegmentAt>
[[nodiscard]] double cell_for_density(std::size_t count, SegmentAt segment_at, double coarse_mm,
                                      double least_mm) {
  constexpr double kFew = 64;      // pairs of a segment that cost less than another index
  constexpr double kSaves = 0.75;  // what a smaller cell must bring the work down to
  double cell = coarse_mm;
  if (count == 0) return cell;
  double work = neighbour_pairs(count, segment_at, cell);
  while (work > kFew * static_cast<double>(count) && cell / 2 >= least_mm) {
    const double finer = neighbour_pairs(count, segment_at, cell / 2);
    if (finer > kSaves * work) break;
    work = finer;
    cell /= 2;
  }
  return cell;
}

}  // namespace popcut
