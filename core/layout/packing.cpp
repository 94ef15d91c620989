// SPDX-License-Identifier: MIT
#include "core/layout/packing.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

namespace popcut {
namespace {

constexpr double kRounding = 1e-6;       // mm; rounding errors up to this size still fit
constexpr std::size_t kOpenSheets = 32;  // older sheets are most likely full

// The lower edge of the used area of a sheet, from left to right.
class Skyline {
 public:
  explicit Skyline(const std::array<double, 2>& area) : area_(area), steps_{{0.0, 0.0}} {}

  struct Spot {
    double x{}, y{}, top{std::numeric_limits<double>::infinity()};
    std::size_t step{};
    [[nodiscard]] bool found() const { return top < std::numeric_limits<double>::infinity(); }
  };

  // Where a box of this size ends up highest on the sheet; of equal places the leftmost.
  [[nodiscard]] Spot find(double width, double height) const {
    Spot best;
    for (std::size_t i = 0; i < steps_.size(); ++i) {
      const double x = steps_[i].x;
      if (x + width > area_[0] + kRounding) break;
      double y = steps_[i].y;
      for (std::size_t j = i + 1; j < steps_.size() && steps_[j].x < x + width - kRounding; ++j)
        y = std::max(y, steps_[j].y);
      if (y + height > area_[1] + kRounding || y + height >= best.top) continue;
      best = {x, y, y + height, i};
    }
    return best;
  }

  void take(const Spot& spot, double width, double height) {
    const double end = spot.x + width;
    double under = steps_[spot.step].y;
    std::size_t j = spot.step;
    for (; j < steps_.size() && steps_[j].x < end - kRounding; ++j) under = steps_[j].y;
    const auto first = steps_.begin() + static_cast<std::ptrdiff_t>(spot.step);
    const auto last = steps_.begin() + static_cast<std::ptrdiff_t>(j);
    const auto at = steps_.erase(first, last);
    const auto put = steps_.insert(at, {spot.x, spot.y + height});
    const bool at_next = put + 1 != steps_.end() && (put + 1)->x <= end + kRounding;
    if (!at_next && end < area_[0] - kRounding) steps_.insert(put + 1, {end, under});
  }

 private:
  struct Step {
    double x{}, y{};
  };
  std::array<double, 2> area_;
  std::vector<Step> steps_;
};

}  // namespace

std::vector<PackedBox> pack(const std::vector<std::array<double, 2>>& sizes,
                            const std::array<double, 2>& area, double spacing) {
  // Each box grows by the spacing, and so does the area.
  const std::array<double, 2> grown{area[0] + spacing, area[1] + spacing};
  std::vector<std::uint32_t> order(sizes.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::max(sizes[a][0], sizes[a][1]) > std::max(sizes[b][0], sizes[b][1]);
  });
  std::vector<PackedBox> packed(sizes.size());
  std::vector<Skyline> sheets;
  for (const std::uint32_t box : order) {
    const double w = sizes[box][0] + spacing, h = sizes[box][1] + spacing;
    const auto place = [&](std::size_t s) {
      const Skyline::Spot straight = sheets[s].find(w, h), turned = sheets[s].find(h, w);
      if (!straight.found() && !turned.found()) return false;
      const bool turn = turned.top < straight.top - kRounding;
      const Skyline::Spot& spot = turn ? turned : straight;
      sheets[s].take(spot, turn ? h : w, turn ? w : h);
      packed[box] = {static_cast<std::uint32_t>(s), spot.x, spot.y, turn};
      return true;
    };
    bool placed = false;
    for (std::size_t s = sheets.size() > kOpenSheets ? sheets.size() - kOpenSheets : 0;
         s < sheets.size() && !placed; ++s)
      placed = place(s);
    if (placed) continue;
    sheets.emplace_back(grown);
    (void)place(sheets.size() - 1);
  }
  return packed;
}

}  // namespace popcut
