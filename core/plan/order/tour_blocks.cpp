// SPDX-License-Identifier: MIT
#include "core/plan/order/tour_blocks.hpp"

#include <algorithm>
#include <cmath>

namespace popcut {

BlockTour::BlockTour(std::span<const std::uint32_t> sequence, std::span<const std::uint8_t> flipped)
    : at_(sequence.size()),
      place_(sequence.size()),
      flipped_(flipped.begin(), flipped.end()),
      scratch_(sequence.size()) {
  const auto n = static_cast<double>(sequence.size());
  block_size_ = std::max(8u, static_cast<std::uint32_t>(0.7 * std::sqrt(n)));
  lay_out(sequence);
}

void BlockTour::lay_out(std::span<const std::uint32_t> sequence) {
  blocks_.clear();
  order_.clear();
  const auto n = static_cast<std::uint32_t>(sequence.size());
  for (std::uint32_t begin = 0; begin < n; begin += block_size_) {
    const auto b = static_cast<std::uint32_t>(blocks_.size());
    blocks_.push_back({begin, std::min(begin + block_size_, n), b, begin, 0});
    order_.push_back(b);
    for (std::uint32_t i = begin; i < blocks_[b].end; ++i) {
      at_[i] = sequence[i];
      place_[sequence[i]] = {b, i};
    }
  }
  most_blocks_ = 2 * static_cast<std::uint32_t>(blocks_.size()) + 8;
}

void BlockTour::gather() {
  std::uint32_t out = 0;
  for (const std::uint32_t b : order_) {
    const Block& block = blocks_[b];
    for (std::uint32_t i = block.begin; i < block.end; ++i) {
      const std::uint32_t stop = at_[block.turned == 0 ? i : block.end - 1 - (i - block.begin)];
      flipped_[stop] ^= block.turned;
      scratch_[out++] = stop;
    }
  }
  lay_out(scratch_);
}

// Reverses a short part by swapping stops from both ends inwards, across blocks.
void BlockTour::swap_stops(std::uint32_t first, std::uint32_t last, std::uint32_t count) {
  for (; count > 1; count -= 2) {
    const std::uint32_t after = next(first), before = prev(last);
    const Place a = place_[first], b = place_[last];
    // A stop's mark is relative to its block. Both stops flip, and both may change to another
    // block.
    const std::uint8_t change = 1u ^ blocks_[a.block].turned ^ blocks_[b.block].turned;
    flipped_[first] ^= change;
    flipped_[last] ^= change;
    at_[a.at] = last;
    at_[b.at] = first;
    place_[first] = b;
    place_[last] = a;
    first = after;
    last = before;
  }
  if (count == 1) flipped_[first] ^= 1u;
}

// Splits the block of `stop` so that in tour order a block begins with it.
void BlockTour::start_block_at(std::uint32_t stop) {
  const Place p = place_[stop];
  Block& block = blocks_[p.block];
  if (front(block) == stop) return;
  const auto added = static_cast<std::uint32_t>(blocks_.size());
  Block later = block;  // the new block: what comes later in tour order
  if (block.turned == 0) {
    later.begin = block.end = p.at;
  } else {
    later.end = block.begin = p.at + 1;
  }
  later.position = block.position + (block.end - block.begin);
  later.rank = block.rank + 1;
  for (std::uint32_t i = later.begin; i < later.end; ++i) place_[at_[i]].block = added;
  order_.insert(order_.begin() + later.rank, added);
  blocks_.push_back(later);
  for (auto r = static_cast<std::size_t>(later.rank) + 1; r < order_.size(); ++r)
    ++blocks_[order_[r]].rank;
}

// Reverses the blocks of ranks from .. to (to < from: across the end of the list).
void BlockTour::turn_blocks(std::uint32_t from, std::uint32_t to) {
  const auto n = static_cast<std::uint32_t>(order_.size());
  const std::uint32_t count = (to >= from ? to - from : to + n - from) + 1;
  // If the part goes across the end of the list, the number of blocks before that end may change.
  const std::uint32_t first = to >= from ? from : 0, last = to >= from ? to : n - 1;
  std::uint32_t position = blocks_[order_[first]].position;
  for (std::uint32_t k = 0; k < count; ++k) {
    const std::uint32_t rank = from + k < n ? from + k : from + k - n;
    blocks_[order_[rank]].turned ^= 1u;
  }
  for (std::uint32_t i = from, j = to, left = count; left > 1; left -= 2) {
    std::swap(order_[i], order_[j]);
    i = i + 1 == n ? 0 : i + 1;
    j = j == 0 ? n - 1 : j - 1;
  }
  for (std::uint32_t rank = first; rank <= last; ++rank) {
    Block& block = blocks_[order_[rank]];
    block.rank = rank;
    block.position = position;
    position += block.end - block.begin;
  }
}

bool BlockTour::reverse(std::uint32_t first, std::uint32_t last) {
  const std::uint32_t n = size(), i = position(first), j = position(last);
  std::uint32_t count = (j >= i ? j - i : j + n - i) + 1;
  const bool part = 2 * count <= n;
  if (!part) {
    if (count == n) return part;
    const std::uint32_t before = prev(first);
    first = next(last);
    last = before;
    count = n - count;
  }
  if (count <= block_size_ || count < 4) {
    swap_stops(first, last, count);
    return part;
  }
  start_block_at(first);
  start_block_at(next(last));
  turn_blocks(blocks_[place_[first].block].rank, blocks_[place_[last].block].rank);
  if (blocks_.size() > most_blocks_) gather();
  return part;
}

}  // namespace popcut
