// SPDX-License-Identifier: MIT
#include "core/plan/order/tour_improve.hpp"

#include <limits>

#include "core/plan/order/tour_array.hpp"
#include "core/plan/order/tour_blocks.hpp"
#include "core/plan/order/tour_search.hpp"

namespace popcut {
namespace {

constexpr std::uint32_t kLargestArray = 1500;  // stops; beyond this, blocks are faster

// Steele, Lea and Flood 2014 (splitmix64): small, and gives the same numbers on every machine.
class SplitMix64 {
 public:
  explicit SplitMix64(std::uint64_t seed) : state_(seed) {}
  std::uint32_t below(std::uint32_t n) {
    state_ += 0x9e3779b97f4a7c15u;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    z ^= z >> 31;
    return static_cast<std::uint32_t>(((z >> 32) * n) >> 32);
  }

 private:
  std::uint64_t state_;
};

template <typename Tour>
Improved improve(TourStops& stops, const NearNodes& near, TourOrder& order,
                 const ImproveOptions& options, const KeepGoing& keep_going) {
  Improved result;
  TourSearch<Tour> search(stops, near, order);
  for (const std::uint32_t stop : order.sequence) search.wake(stop);
  const auto first = [&] { return !keep_going || keep_going(0.0); };
  result.finished = search.descend(first);
  search.keep();
  const std::uint32_t n = stops.size();
  const std::uint32_t longest = std::min(30u, (n - 1) / 3);
  SplitMix64 generator(options.seed);
  const auto always = [] { return true; };
  for (std::uint64_t kick = 0; result.finished && n >= 8 && kick < options.kicks; ++kick) {
    if (kick % 256 == 0 && keep_going) {
      result.finished = keep_going(static_cast<double>(kick) / static_cast<double>(options.kicks));
      if (!result.finished) break;
    }
    ++result.kicks;
    const double before = search.gained();
    const double cost = search.disturb(generator.below(n), 1 + generator.below(longest),
                                       1 + generator.below(longest));
    if (cost == std::numeric_limits<double>::infinity()) continue;
    search.descend(always);
    if (search.gained() < before - 1e-12)
      search.revert(before);
    else
      search.keep();
  }
  order = search.order();
  return result;
}

}  // namespace

Improved improve_tour(TourStops& stops, const NearNodes& near, TourOrder& order,
                      const ImproveOptions& options, const KeepGoing& keep_going) {
  if (stops.size() < 3) return {};
  return stops.size() > kLargestArray ? improve<BlockTour>(stops, near, order, options, keep_going)
                                      : improve<ArrayTour>(stops, near, order, options, keep_going);
}

}  // namespace popcut
