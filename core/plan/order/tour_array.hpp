// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace popcut {

/// A round tour in one array. Its stops 0 .. n-1 each have two ends: the tour enters at one and
/// leaves at the other. All operations are O(1) except `reverse`, which is linear in the shorter of
/// the two parts.
class ArrayTour {
 public:
  /// @param sequence  each stop once
  /// @param flipped   per stop: whether the tour enters at its second end
  ArrayTour(std::span<const std::uint32_t> sequence, std::span<const std::uint8_t> flipped)
      : at_(sequence.begin(), sequence.end()),
        position_(sequence.size()),
        flipped_(flipped.begin(), flipped.end()) {
    for (std::uint32_t i = 0; i < at_.size(); ++i) position_[at_[i]] = i;
  }

  [[nodiscard]] std::uint32_t size() const { return static_cast<std::uint32_t>(at_.size()); }
  [[nodiscard]] std::uint32_t next(std::uint32_t stop) const {
    const std::uint32_t i = position_[stop] + 1;
    return at_[i == at_.size() ? 0 : i];
  }
  [[nodiscard]] std::uint32_t prev(std::uint32_t stop) const {
    const std::uint32_t i = position_[stop];
    return at_[i == 0 ? at_.size() - 1 : i - 1];
  }
  [[nodiscard]] bool flipped(std::uint32_t stop) const { return flipped_[stop] != 0; }
  [[nodiscard]] std::uint32_t position(std::uint32_t stop) const { return position_[stop]; }

  /// Reverses the part from `first` to `last`, or all the rest, which gives the same round tour.
  ///
  /// @return whether it reversed the part itself: then `reverse(last, first)` undoes it, otherwise
  ///         `reverse(first, last)` does
  bool reverse(std::uint32_t first, std::uint32_t last) {
    const std::uint32_t n = size();
    std::uint32_t i = position_[first], j = position_[last];
    std::uint32_t count = (j >= i ? j - i : j + n - i) + 1;
    const bool part = 2 * count <= n;
    if (!part) {
      const std::uint32_t k = i;
      i = j + 1 == n ? 0 : j + 1;
      j = k == 0 ? n - 1 : k - 1;
      count = n - count;
    }
    for (std::uint32_t swaps = count / 2; swaps > 0; --swaps) {
      put(i, j);
      i = i + 1 == n ? 0 : i + 1;
      j = j == 0 ? n - 1 : j - 1;
    }
    if (count % 2 == 1) flipped_[at_[i]] ^= 1u;
    return part;
  }

 private:
  // Swaps the stops at i and j and flips both.
  void put(std::uint32_t i, std::uint32_t j) {
    const std::uint32_t a = at_[i], b = at_[j];
    at_[i] = b;
    at_[j] = a;
    position_[b] = i;
    position_[a] = j;
    flipped_[a] ^= 1u;
    flipped_[b] ^= 1u;
  }

  std::vector<std::uint32_t> at_, position_;
  std::vector<std::uint8_t> flipped_;
};

}  // namespace popcut
