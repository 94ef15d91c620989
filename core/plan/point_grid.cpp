// SPDX-License-Identifier: MIT
#include "core/plan/point_grid.hpp"

#include <algorithm>
#include <cmath>

#include "core/plan/linework.hpp"

namespace popcut {

PointGrid::PointGrid(std::span<const PagePoint> points) : points_(points.begin(), points.end()) {
  Box box;
  for (const PagePoint& p : points_) box.add(p);
  if (points_.empty()) box = {0.0, 0.0, 0.0, 0.0};
  const double n = static_cast<double>(points_.size()) + 1.0;
  cell_ = std::max(
      {std::sqrt(box.width() * box.height() / n), (box.width() + box.height()) / (2.0 * n), 1e-6});
  x0_ = box.x0;
  y0_ = box.y0;
  columns_ = static_cast<std::int64_t>(box.width() / cell_) + 1;
  rows_ = static_cast<std::int64_t>(box.height() / cell_) + 1;
  const auto cell_of = [&](const PagePoint& p) {
    return static_cast<std::size_t>(row(p.y) * columns_ + column(p.x));
  };
  first_.assign(static_cast<std::size_t>(columns_ * rows_) + 1, 0);
  for (const PagePoint& p : points_) ++first_[cell_of(p) + 1];
  for (std::size_t c = 1; c < first_.size(); ++c) first_[c] += first_[c - 1];
  items_.resize(points_.size());
  std::vector<std::uint32_t> fill(first_.begin(), first_.end() - 1);
  for (std::uint32_t i = 0; i < points_.size(); ++i) items_[fill[cell_of(points_[i])]++] = i;
}

std::int64_t PointGrid::column(double x) const {
  return static_cast<std::int64_t>(
      std::clamp(std::floor((x - x0_) / cell_), 0.0, static_cast<double>(columns_ - 1)));
}

std::int64_t PointGrid::row(double y) const {
  return static_cast<std::int64_t>(
      std::clamp(std::floor((y - y0_) / cell_), 0.0, static_cast<double>(rows_ - 1)));
}

}  // namespace popcut
