// SPDX-License-Identifier: MIT
#include "core/plan/segment_grid.hpp"

#include <algorithm>
#include <cmath>

#include "core/plan/linework.hpp"

namespace popcut {

SegmentGrid::SegmentGrid(std::span<const Segment> segments, double reach) : reach_(reach) {
  Box box;
  double total = 0.0;
  for (const Segment& s : segments) {
    box.add(s.a);
    box.add(s.b);
    total += distance(s.a, s.b);
  }
  if (segments.empty()) box = {0.0, 0.0, 0.0, 0.0};
  // As many cells as segments, but none so small that the lines take more than 8 cells on average.
  const double n = static_cast<double>(segments.size()) + 1.0;
  cell_ = std::max({std::sqrt(box.width() * box.height() / n), total / (8.0 * n), 2.0 * reach,
                    (box.width() + box.height()) / (4.0 * n)});
  x0_ = box.x0;
  y0_ = box.y0;
  columns_ = static_cast<std::int64_t>(box.width() / cell_) + 1;
  rows_ = static_cast<std::int64_t>(box.height() / cell_) + 1;
  first_.assign(static_cast<std::size_t>(columns_ * rows_) + 1, 0);
  for (const Segment& s : segments) visit(s, 0.0, [&](std::size_t cell) { ++first_[cell + 1]; });
  for (std::size_t c = 1; c < first_.size(); ++c) first_[c] += first_[c - 1];
  items_.resize(first_.back());
  seen_.assign(segments.size(), 0);
  std::vector<std::uint32_t> fill(first_.begin(), first_.end() - 1);
  for (std::uint32_t i = 0; i < segments.size(); ++i)
    visit(segments[i], 0.0, [&](std::size_t cell) { items_[fill[cell]++] = i; });
}

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

void SegmentGrid::near(const Segment& segment, std::vector<std::uint32_t>& out) {
  out.clear();
  ++query_;
  visit(segment, reach_, [&](std::size_t cell) {
    for (std::uint32_t q = first_[cell]; q < first_[cell + 1]; ++q)
      if (seen_[items_[q]] != query_) {
        seen_[items_[q]] = query_;
        out.push_back(items_[q]);
      }
  });
}

}  // namespace popcut
