// SPDX-License-Identifier: MIT
#include "core/geometry/node_index.hpp"

#include <bit>
#include <cmath>

namespace popcut {

NodeIndex::NodeIndex(double reach, std::size_t expected)
    : cell_(2 * reach), head_(std::bit_ceil(expected + 16), kNone) {
  next_.reserve(expected);
  points_.reserve(expected);
}

std::int64_t NodeIndex::cell(double value) const {
  return static_cast<std::int64_t>(std::floor(value / cell_));
}

// The cells of a block of 8 x 8 are adjacent in memory, so that points drawn nearby are near in
// memory too.
std::size_t NodeIndex::slot(std::int64_t cx, std::int64_t cy) const {
  std::uint64_t h = static_cast<std::uint64_t>(cx >> 3) * 0x9E3779B97F4A7C15ULL;
  h ^= static_cast<std::uint64_t>(cy >> 3) * 0xC2B2AE3D27D4EB4FULL;
  h ^= h >> 29;
  h *= 0xBF58476D1CE4E5B9ULL;
  h ^= h >> 32;
  return (h << 6 | static_cast<std::uint64_t>((cx & 7) | (cy & 7) << 3)) & (head_.size() - 1);
}

std::uint32_t NodeIndex::add(const PagePoint& p) {
  const auto node = static_cast<std::uint32_t>(points_.size());
  points_.push_back(p);
  std::uint32_t& head = head_[slot(cell(p.x), cell(p.y))];
  next_.push_back(head);
  head = node;
  return node;
}

}  // namespace popcut
