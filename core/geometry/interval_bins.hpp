// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/geometry/buckets.hpp"

namespace popcut {

/// Things that reach over a stretch of one coordinate, in bins of equal width: what lies at a place
/// of it is in one bin. For straight seams and rays, which pass a whole drawing and ask for one
/// coordinate only: a grid of cells would be walked from end to end.
class IntervalBins {
 public:
  IntervalBins() = default;
  /// `interval(i)` is the stretch from..to of thing `i` of `which`, within `from`..`to`. At most
  /// `most_bins`, and fewer where long stretches would take more than 8 entries each.
  template <typename Interval>
  IntervalBins(double from, double to, std::size_t most_bins, std::span<const std::uint32_t> which,
               Interval&& interval)
      : from_(from) {
    std::size_t count = std::max<std::size_t>(most_bins, 1);
    for (;; count /= 2) {
      width_ = std::max((to - from) / static_cast<double>(count), 1e-9);
      double entries = 0.0;
      for (const std::uint32_t i : which) {
        const std::pair<double, double> reach = interval(i);
        entries += 2 + (reach.second - reach.first) / width_;
      }
      if (count == 1 || entries <= 8.0 * static_cast<double>(which.size()) + 4096) break;
    }
    last_ = static_cast<double>(count - 1);
    bins_ = Buckets<std::uint32_t>(count, [&](auto&& put) {
      for (const std::uint32_t i : which) {
        const std::pair<double, double> reach = interval(i);
        const std::size_t end = bin(reach.second);
        for (std::size_t k = bin(reach.first); k <= end; ++k) put(k, i);
      }
    });
  }

  /// The bin of a place; beyond the ends the nearest one.
  [[nodiscard]] std::size_t bin(double at) const {
    return static_cast<std::size_t>(std::clamp((at - from_) / width_, 0.0, last_));
  }
  [[nodiscard]] std::span<const std::uint32_t> at(double place) const { return bins_[bin(place)]; }
  [[nodiscard]] Buckets<std::uint32_t>& bins() { return bins_; }
  [[nodiscard]] const Buckets<std::uint32_t>& bins() const { return bins_; }

 private:
  double from_{}, width_{1.0}, last_{};
  Buckets<std::uint32_t> bins_;
};

}  // namespace popcut
