// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "core/geometry/buckets.hpp"
#include "core/geometry/cell_walk.hpp"

namespace popcut {

/// Segments in a uniform grid that is built once: which of them come near a given one? The index
/// for whatever asks that. Boost.Geometry's rtree takes 1.6 times as long
/// (tests/bench/spatial_bench).
class SegmentGrid {
 public:
  /// @param reach  how far is near, mm
  /// @param fine   cells of twice the reach even if segments are long, up to 16 million entries
  SegmentGrid(std::span<const Segment> segments, double reach, bool fine = false);

  /// The indices of all segments in cells within reach of `segment`, each once.
  void near(const Segment& segment, std::vector<std::uint32_t>& out);

  /// Calls `cell(centre, items)` for each non-empty cell within reach of `segment`.
  template <typename Cell>
  void each_cell(const Segment& segment, Cell&& cell) const {
    visit(segment, reach_, [&](std::size_t c) {
      if (cells_[c].empty()) return;
      const auto columns = static_cast<std::size_t>(columns_);
      const std::size_t column = c % columns, row = c / columns;
      cell(PagePoint{x0_ + (static_cast<double>(column) + 0.5) * cell_,
                     y0_ + (static_cast<double>(row) + 0.5) * cell_},
           cells_[c]);
    });
  }
  [[nodiscard]] double cell_mm() const { return cell_; }

 private:
  template <typename Visit>
  void visit(const Segment& segment, double reach, Visit&& visit) const;

  double reach_;
  double cell_{1.0};
  double x0_{}, y0_{};
  std::int64_t columns_{1}, rows_{1};
  Buckets<std::uint32_t> cells_;
  std::vector<std::uint32_t> seen_;  ///< query that met the segment last
  std::uint32_t query_{};
};

template <typename Visit>
void SegmentGrid::visit(const Segment& s, double reach, Visit&& visit_cell) const {
  const auto clamp_to = [](double value, std::int64_t count) {
    return static_cast<std::int64_t>(
        std::clamp(std::floor(value), 0.0, static_cast<double>(count - 1)));
  };
  const bool flat = std::abs(s.b.x - s.a.x) >= std::abs(s.b.y - s.a.y);
  const double origin_major = flat ? x0_ : y0_, origin_minor = flat ? y0_ : x0_;
  const std::int64_t majors = flat ? columns_ : rows_, minors = flat ? rows_ : columns_;
  double m0 = flat ? s.a.x : s.a.y, n0 = flat ? s.a.y : s.a.x;
  double m1 = flat ? s.b.x : s.b.y, n1 = flat ? s.b.y : s.b.x;
  if (m0 > m1) {
    std::swap(m0, m1);
    std::swap(n0, n1);
  }
  const double slope = m1 > m0 ? (n1 - n0) / (m1 - m0) : 0.0;
  const std::int64_t last = clamp_to((m1 + reach - origin_major) / cell_, majors);
  for (std::int64_t c = clamp_to((m0 - reach - origin_major) / cell_, majors); c <= last; ++c) {
    const double from = std::clamp(origin_major + static_cast<double>(c) * cell_ - reach, m0, m1);
    const double to = std::clamp(origin_major + static_cast<double>(c + 1) * cell_ + reach, m0, m1);
    const double a = n0 + slope * (from - m0), b = n0 + slope * (to - m0);
    const std::int64_t top = clamp_to((std::max(a, b) + reach - origin_minor) / cell_, minors);
    for (std::int64_t d = clamp_to((std::min(a, b) - reach - origin_minor) / cell_, minors);
         d <= top; ++d)
      visit_cell(static_cast<std::size_t>(flat ? d * columns_ + c : c * columns_ + d));
  }
}

}  // namespace popcut
