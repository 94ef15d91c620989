// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace popcut {

/// A round tour like `ArrayTour`, kept in a list of about sqrt(n) blocks in tour order, each of
/// which a mark can reverse. So `reverse` takes O(sqrt n): it splits blocks at the ends of the
/// part, then reverses the list of the part's blocks. When splitting has doubled the number of
/// blocks, the tour is laid out again: O(n) once per O(sqrt n) calls.
class BlockTour {
 public:
  BlockTour(std::span<const std::uint32_t> sequence, std::span<const std::uint8_t> flipped);

  [[nodiscard]] std::uint32_t size() const { return static_cast<std::uint32_t>(place_.size()); }
  [[nodiscard]] std::uint32_t next(std::uint32_t stop) const {
    const Place& p = place_[stop];
    const Block& b = blocks_[p.block];
    if (b.turned == 0 ? p.at + 1 < b.end : p.at > b.begin)
      return at_[b.turned == 0 ? p.at + 1 : p.at - 1];
    const std::uint32_t rank = b.rank + 1;
    return front(blocks_[order_[rank == order_.size() ? 0 : rank]]);
  }
  [[nodiscard]] std::uint32_t prev(std::uint32_t stop) const {
    const Place& p = place_[stop];
    const Block& b = blocks_[p.block];
    if (b.turned == 0 ? p.at > b.begin : p.at + 1 < b.end)
      return at_[b.turned == 0 ? p.at - 1 : p.at + 1];
    return back(blocks_[order_[b.rank == 0 ? order_.size() - 1 : b.rank - 1]]);
  }
  [[nodiscard]] bool flipped(std::uint32_t stop) const {
    return (flipped_[stop] ^ blocks_[place_[stop].block].turned) != 0;
  }
  [[nodiscard]] std::uint32_t position(std::uint32_t stop) const {
    const Place& p = place_[stop];
    const Block& b = blocks_[p.block];
    return b.position + (b.turned == 0 ? p.at - b.begin : b.end - 1 - p.at);
  }

  /// Like `ArrayTour::reverse`.
  bool reverse(std::uint32_t first, std::uint32_t last);

 private:
  struct Place {
    std::uint32_t block, at;
  };
  struct Block {
    std::uint32_t begin{}, end{};  // range in `at_`
    std::uint32_t rank{};          // index in `order_`
    std::uint32_t position{};      // position of its first stop
    std::uint8_t turned{};
  };

  [[nodiscard]] std::uint32_t front(const Block& b) const {
    return at_[b.turned == 0 ? b.begin : b.end - 1];
  }
  [[nodiscard]] std::uint32_t back(const Block& b) const {
    return at_[b.turned == 0 ? b.end - 1 : b.begin];
  }
  void lay_out(std::span<const std::uint32_t> sequence);
  void gather();
  void swap_stops(std::uint32_t first, std::uint32_t last, std::uint32_t count);
  void start_block_at(std::uint32_t stop);
  void turn_blocks(std::uint32_t from, std::uint32_t to);

  std::vector<std::uint32_t> at_;
  std::vector<Place> place_;
  std::vector<std::uint8_t> flipped_;
  std::vector<Block> blocks_;
  std::vector<std::uint32_t> order_;
  std::uint32_t block_size_{1}, most_blocks_{1};
  std::vector<std::uint32_t> scratch_;
};

}  // namespace popcut
