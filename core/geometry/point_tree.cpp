// SPDX-License-Identifier: MIT
#include "core/geometry/point_tree.hpp"

#include <algorithm>
#include <tuple>

#include "core/geometry/page_point.hpp"

namespace popcut {

PointTree::PointTree(std::span<const PagePoint> points, std::span<const std::uint32_t> tags) {
  sorted_.reserve(points.size());
  for (std::uint32_t i = 0; i < points.size(); ++i)
    sorted_.push_back({points[i].x, points[i].y, tags[i], i});
  std::size_t leaves = 1;
  while (leaves * kLeaf < points.size()) leaves *= 2;
  splits_.resize(leaves);
  halve(1, 0, static_cast<std::uint32_t>(sorted_.size()));
  place_.resize(points.size());
  for (std::uint32_t i = 0; i < sorted_.size(); ++i) place_[sorted_[i].number] = i;
}

void PointTree::halve(std::size_t node, std::uint32_t low, std::uint32_t high) {
  if (high - low <= kLeaf) return;
  Box box;
  for (std::uint32_t i = low; i < high; ++i) box.add({sorted_[i].x, sorted_[i].y});
  const bool by_y = box.height() > box.width();
  const std::uint32_t middle = low + (high - low) / 2;
  const auto begin = sorted_.begin();
  const auto before = [by_y](const Entry& a, const Entry& b) {
    return by_y ? std::tie(a.y, a.number) < std::tie(b.y, b.number)
                : std::tie(a.x, a.number) < std::tie(b.x, b.number);
  };
  std::nth_element(begin + low, begin + middle, begin + high, before);
  splits_[node] = {by_y ? sorted_[middle].y : sorted_[middle].x, by_y};
  halve(2 * node, low, middle);
  halve(2 * node + 1, middle, high);
}

}  // namespace popcut
