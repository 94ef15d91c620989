// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace popcut {

/// Items in numbered slots, laid out once and without gaps: counted first, then filled.
template <typename Item>
class Buckets {
 public:
  Buckets() = default;
  /// `each(put)` calls `put(slot, item)` for all items. It is called twice and says the same both
  /// times; within a slot items keep its order.
  template <typename Each>
  Buckets(std::size_t slots, Each&& each) : first_(slots + 1, 0) {
    each([&](std::size_t slot, const Item&) { ++first_[slot + 1]; });
    for (std::size_t s = 1; s < first_.size(); ++s) first_[s] += first_[s - 1];
    items_.resize(first_.back());
    each([&](std::size_t slot, const Item& item) { items_[first_[slot]++] = item; });
    for (std::size_t s = first_.size() - 1; s > 0; --s) first_[s] = first_[s - 1];
    first_[0] = 0;
  }

  [[nodiscard]] std::size_t size() const { return first_.empty() ? 0 : first_.size() - 1; }
  [[nodiscard]] std::span<const Item> operator[](std::size_t slot) const {
    return std::span(items_).subspan(first_[slot], first_[slot + 1] - first_[slot]);
  }
  [[nodiscard]] std::span<Item> operator[](std::size_t slot) {
    return std::span(items_).subspan(first_[slot], first_[slot + 1] - first_[slot]);
  }
  /// Where a slot begins among all items.
  [[nodiscard]] std::size_t begin_of(std::size_t slot) const { return first_[slot]; }
  [[nodiscard]] std::span<const Item> items() const { return items_; }

 private:
  std::vector<std::uint32_t> first_;
  std::vector<Item> items_;
};

}  // namespace popcut
