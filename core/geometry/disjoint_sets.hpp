// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace popcut {

/// Sets of the numbers 0 .. n - 1 that grow together. Each set is known by its least number, so
/// that what is numbered by sets does not depend on the order in which they were joined: that is
/// what `boost::disjoint_sets`, whose representative depends on ranks, does not promise. Paths are
/// halved on the way (Tarjan and van Leeuwen 1984): nearly O(1) a call.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count = 0) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), 0U);
  }
  /// One more number, in a set of its own.
  std::uint32_t add() {
    parent_.push_back(static_cast<std::uint32_t>(parent_.size()));
    return parent_.back();
  }
  /// The least number of the set that holds `i`.
  [[nodiscard]] std::uint32_t find(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  /// @return false where both are in one set already
  bool join(std::uint32_t a, std::uint32_t b) {
    a = find(a);
    b = find(b);
    parent_[std::max(a, b)] = std::min(a, b);
    return a != b;
  }
  /// The sets numbered from 0 on by their least members: the number of each member's set.
  /// @return how many sets there are
  std::size_t number(std::vector<std::uint32_t>& set_of) {
    set_of.resize(parent_.size());
    std::uint32_t sets = 0;
    for (std::uint32_t i = 0; i < parent_.size(); ++i) {
      const std::uint32_t least = find(i);
      set_of[i] = least == i ? sets++ : set_of[least];
    }
    return sets;
  }

 private:
  std::vector<std::uint32_t> parent_;
};

}  // namespace popcut
