// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "core/geometry/vec.hpp"

namespace popcut {

/// Limit of candidate pairs among `shapes`; drawings with more are too dense to check. Sound
/// drawings need some tens per shape.
[[nodiscard]] constexpr std::uint64_t pair_budget(std::size_t shapes) {
  return 1'000'000 + 500 * static_cast<std::uint64_t>(shapes);
}

/// Finds which convex shapes of a plane can touch: a square grid whose cells hold the shapes that
/// reach into them. The cell size is chosen so that cells hold few shapes and entries stay O(n).
///
/// For all pairs of polygons at once, in cells that have the shapes' own proportions: `SegmentGrid`
/// answers for one segment after the other, in square cells, and takes no polygons.
class CellGrid {
 public:
  /// `corners(i)` returns the corners of shape `i` (two for a segment) as a range with begin, end
  /// and size. `slack_mm` is added around each shape.
  template <typename Corners>
  CellGrid(std::size_t shapes, double slack_mm, Corners corners) : slack_(slack_mm) {
    if (shapes == 0) return;
    double along_u = 0.0, along_v = 0.0;
    low_ = *corners(0).begin();
    high_ = low_;
    for (std::size_t i = 0; i < shapes; ++i) {
      const auto shape = corners(i);
      Vec2 least = *shape.begin(), most = least;
      for (const Vec2& p : shape) {
        least = least.cwiseMin(p);
        most = most.cwiseMax(p);
      }
      low_ = low_.cwiseMin(least);
      high_ = high_.cwiseMax(most);
      along_u += most.x() - least.x();
      along_v += most.y() - least.y();
    }
    // Cells have the shapes' own proportions, so that thin parallel strips do not share a cell.
    const auto n = static_cast<double>(shapes);
    const auto size = [&](double sum, double side) {
      return std::max({sum / n, side / std::sqrt(4.0 * n + 16.0) / 4.0, side / 30'000.0, 1e-12});
    };
    cell_u_ = size(along_u, high_.x() - low_.x() + 4.0 * slack_mm);
    cell_v_ = size(along_v, high_.y() - low_.y() + 4.0 * slack_mm);
    while (!build(shapes, corners)) cell_u_ *= 1.5, cell_v_ *= 1.5;
  }

  /// Calls `visit(i, j)`, i < j, for every two shapes that share a cell, perhaps more than once.
  /// Gives up and returns false after more than `budget` pairs.
  template <typename Visit>
  [[nodiscard]] bool each_pair(std::uint64_t budget, Visit visit) const {
    return each_pair_of_groups(
        budget, [](std::uint32_t i) { return i; }, visit);
  }

  /// The same for shapes of different groups: `group(i)` is one number per run of shapes. Pairs
  /// within a group do not count.
  template <typename Group, typename Visit>
  [[nodiscard]] bool each_pair_of_groups(std::uint64_t budget, Group group, Visit visit) const {
    for (std::size_t c = 0; c + 1 < first_.size(); ++c) {
      const auto inside = std::span(item_).subspan(first_[c], first_[c + 1] - first_[c]);
      std::size_t past = 0;  // end of the run that shape i belongs to
      for (std::size_t i = 0; i < inside.size(); ++i) {
        past = std::max(past, i + 1);
        while (past < inside.size() && group(inside[past]) == group(inside[i])) ++past;
        const std::uint64_t pairs = inside.size() - past;
        if (pairs > budget) return false;
        budget -= pairs;
        for (std::size_t j = past; j < inside.size(); ++j) visit(inside[i], inside[j]);
      }
    }
    return true;
  }

 private:
  template <typename Corners>
  bool build(std::size_t shapes, Corners corners) {
    columns_ = 1 + static_cast<std::size_t>((high_.x() - low_.x() + 2.0 * slack_) / cell_u_);
    rows_ = 1 + static_cast<std::size_t>((high_.y() - low_.y() + 2.0 * slack_) / cell_v_);
    if (columns_ * rows_ > 16 * shapes + 1024) return false;
    first_.assign(columns_ * rows_ + 1, 0);
    std::size_t entries = 0;
    const std::size_t limit = 64 * shapes + 1024;
    for (std::size_t i = 0; i < shapes && entries <= limit; ++i) {
      each_cell(corners(i), [&](std::size_t c) { ++first_[c + 1], ++entries; });
    }
    if (entries > limit) return false;
    for (std::size_t c = 1; c < first_.size(); ++c) first_[c] += first_[c - 1];
    item_.resize(entries);
    std::vector<std::uint32_t> fill(first_.begin(), first_.end() - 1);
    for (std::size_t i = 0; i < shapes; ++i) {
      each_cell(corners(i),
                [&](std::size_t c) { item_[fill[c]++] = static_cast<std::uint32_t>(i); });
    }
    return true;
  }

  [[nodiscard]] std::size_t index(double offset, double cell, std::size_t count) const {
    return std::min(count - 1, static_cast<std::size_t>(std::max(0.0, (offset + slack_) / cell)));
  }

  /// Visits the cells that a convex shape reaches into, column by column.
  template <typename Shape, typename Visit>
  void each_cell(const Shape& shape, Visit visit) const {
    double from = high_.x();
    double to = low_.x();
    for (const Vec2& p : shape) from = std::min(from, p.x()), to = std::max(to, p.x());
    const std::size_t last = index(to - low_.x() + slack_, cell_u_, columns_);
    for (std::size_t column = index(from - low_.x() - slack_, cell_u_, columns_); column <= last;
         ++column) {
      const double left = low_.x() + cell_u_ * static_cast<double>(column) - 2.0 * slack_;
      const double right = left + cell_u_ + 2.0 * slack_;
      double low = high_.y();
      double high = low_.y();
      const auto* corner = &*shape.begin();
      for (std::size_t k = 0; k < shape.size(); ++k) {
        const Vec2 p = corner[k];
        const Vec2 q = corner[(k + 1) % shape.size()];
        const double width = q.x() - p.x();
        for (const double u : {left, right}) {
          if (width == 0.0 || (u - p.x()) * (u - q.x()) > 0.0) continue;
          const double v = p.y() + (u - p.x()) / width * (q.y() - p.y());
          low = std::min(low, v), high = std::max(high, v);
        }
        if (p.x() >= left && p.x() <= right)
          low = std::min(low, p.y()), high = std::max(high, p.y());
      }
      const std::size_t top = index(high - low_.y() + slack_, cell_v_, rows_);
      for (std::size_t row = index(low - low_.y() - slack_, cell_v_, rows_); row <= top; ++row) {
        visit(row * columns_ + column);
      }
    }
  }

  Vec2 low_{}, high_{};
  double slack_{}, cell_u_{1.0}, cell_v_{1.0};
  std::size_t columns_{}, rows_{};
  std::vector<std::uint32_t> first_, item_;
};

}  // namespace popcut
