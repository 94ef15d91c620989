// SPDX-License-Identifier: MIT
#include "core/design/boxes/block_row.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstdint>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>

#include "core/geometry/angle.hpp"

namespace popcut {
namespace {

constexpr std::size_t kMapCells = 220;
constexpr double kBlockCost = 0.02;  ///< of the volume, that a block must save
constexpr std::size_t kMostCuts = 32;
constexpr double kLeastCut = 0.1;  ///< of the largest change of heights
constexpr double kAside = 0.03;    ///< of the row's width: middles nearer together are one
constexpr double kStraight_rad = radians(0.05);

/// Rows before which the target may be cut, its ends included.
std::vector<std::size_t> cuts_of(const HeightMaps& maps) {
  const BlockGrid& grid = maps.grid;
  std::vector<double> change(grid.rows + 1, 0.0);
  for (std::size_t row = 1; row < grid.rows; ++row)
    for (std::size_t column = 0; column < grid.columns; ++column)
      change[row] += std::abs(maps.top_at(row, column) - maps.top_at(row - 1, column));
  const double least = kLeastCut * *std::max_element(change.begin(), change.end());
  std::vector<std::size_t> order(grid.rows > 1 ? grid.rows - 1 : 0);
  std::iota(order.begin(), order.end(), std::size_t{1});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return change[a] > change[b]; });
  std::vector<std::size_t> out{0, grid.rows};
  for (const std::size_t row : order) {
    if (out.size() >= kMostCuts || change[row] <= least) break;
    if (std::none_of(out.begin(), out.end(), [&](std::size_t other) {
          return std::max(row, other) - std::min(row, other) < 3;
        }))
      out.push_back(row);
  }
  std::sort(out.begin(), out.end());
  return out;
}

struct Stretch {
  std::size_t from_row{}, to_row{};
  Block block;
};

/// The cheapest row of stretches: blocks, and what is left out between them.
struct Chosen {
  std::vector<Stretch> stretches;
  double misfit_mm3{};
};

/// The blocks that all stretches between two cuts are most like, each found once.
class StretchFits {
 public:
  StretchFits(const HeightMaps& maps, const BlockSizes& sizes)
      : maps_(maps), sizes_(sizes), cuts_(cuts_of(maps)), found_(cuts_.size() * cuts_.size()) {}

  [[nodiscard]] const std::vector<std::size_t>& cuts() const { return cuts_; }
  [[nodiscard]] const HeightMaps& maps() const { return maps_; }

  /// @param from, to  of `cuts`
  const std::optional<BlockMisfit>& at(std::size_t from, std::size_t to, bool may_be_pyramid) {
    Found& found = found_[from * cuts_.size() + to];
    std::optional<std::optional<BlockMisfit>>& fit = may_be_pyramid ? found.any : found.unpointed;
    if (!fit) fit = fit_block(maps_, cuts_[from], cuts_[to], sizes_, may_be_pyramid);
    return *fit;
  }

 private:
  struct Found {
    std::optional<std::optional<BlockMisfit>> any, unpointed;
  };
  const HeightMaps& maps_;
  const BlockSizes& sizes_;
  std::vector<std::size_t> cuts_;
  std::vector<Found> found_;
};

/// What ends at a cut: nothing, a block that the next one touches, or one that stands free there.
enum Ending : std::uint8_t { Bare, TouchedBlock, FreeBlock };
constexpr std::array kEndings{Bare, TouchedBlock, FreeBlock};

Chosen chosen_stretches(StretchFits& fits, double block_cost_mm3, const CanStand& can_stand) {
  const std::vector<std::size_t>& cuts = fits.cuts();
  struct Best {
    double cost{std::numeric_limits<double>::infinity()};
    std::size_t from{};
    Ending before{};
    std::optional<Block> block;
  };
  std::vector<std::array<Best, kEndings.size()>> best(cuts.size());
  best[0][Bare].cost = 0.0;
  const auto keep = [](Best& in, Best one) {
    if (one.cost < in.cost) in = std::move(one);
  };
  const auto add_block = [&](std::size_t from, std::size_t to, Ending before) {
    const bool touches = before == TouchedBlock;
    for (const bool may_be_pyramid : {true, false}) {
      const auto& found = fits.at(from, to, may_be_pyramid);
      if (!found) return;
      const auto stands = [&](bool touches_next) {
        return !can_stand || can_stand(found->block, touches, touches_next);
      };
      const Best one{best[from][before].cost + found->misfit_mm3 + block_cost_mm3, from, before,
                     found->block};
      const bool beside_next = stands(true), alone = stands(false);
      if (beside_next) keep(best[to][TouchedBlock], one);
      if (alone) keep(best[to][FreeBlock], one);
      if ((beside_next && alone) || found->block.roof != BlockRoof::Pyramid) return;
    }
  };
  for (std::size_t to = 1; to < cuts.size(); ++to)
    for (std::size_t from = 0; from < to; ++from)
      for (const Ending before : kEndings) {
        const double so_far = best[from][before].cost;
        if (!(so_far < std::numeric_limits<double>::infinity())) continue;
        if (before != FreeBlock) add_block(from, to, before);
        if (before != TouchedBlock)
          keep(best[to][Bare],
               {so_far + volume_of(fits.maps(), cuts[from], cuts[to]), from, before, {}});
      }
  Chosen out;
  Ending ending = best.back()[FreeBlock].cost < best.back()[Bare].cost ? FreeBlock : Bare;
  out.misfit_mm3 = best.back()[ending].cost;
  for (std::size_t at = cuts.size() - 1; at > 0;) {
    const Best& one = best[at][ending];
    if (one.block) out.stretches.push_back({cuts[one.from], cuts[at], *one.block});
    at = one.from, ending = one.before;
  }
  std::reverse(out.stretches.begin(), out.stretches.end());
  out.misfit_mm3 -= block_cost_mm3 * static_cast<double>(out.stretches.size());
  return out;
}

/// The row of a target that has been turned, and what it costs: its misfit, and its blocks.
std::pair<BlockRow, double> row_along_y(const TriangleSoup& target, const BlockSizes& sizes,
                                        StretchFits& fits, const CanStand& can_stand) {
  const HeightMaps& maps = fits.maps();
  const double volume = volume_of(maps, 0, maps.grid.rows);
  BlockRow out;
  if (!(volume > 0.0)) return {out, std::numeric_limits<double>::infinity()};
  const Chosen chosen = chosen_stretches(fits, kBlockCost * volume, can_stand);
  if (chosen.stretches.empty()) return {out, std::numeric_limits<double>::infinity()};
  out.misfit = chosen.misfit_mm3 / volume;
  // The spine is the middle of the largest block; what stands beside it is left out.
  const auto size_of = [&](const Stretch& s) { return volume_of(maps, s.from_row, s.to_row); };
  const Stretch& main = *std::max_element(
      chosen.stretches.begin(), chosen.stretches.end(),
      [&](const Stretch& a, const Stretch& b) { return size_of(a) < size_of(b); });
  out.middle_mm = main.block.middle_mm;
  const double aside = std::max(1.0, kAside * 2.0 * main.block.half_mm);
  std::vector<Stretch> kept;
  for (const Stretch& one : chosen.stretches) {
    if (std::abs(one.block.middle_mm - out.middle_mm) <= aside)
      kept.push_back(one);
    else
      ++out.aside, out.aside_share += size_of(one) / volume;
  }
  for (std::size_t k = 0; k < kept.size(); ++k) {
    Block block = kept[k].block;
    block.middle_mm = out.middle_mm;
    const bool after = k > 0 && kept[k - 1].to_row == kept[k].from_row,
               before = k + 1 < kept.size() && kept[k].to_row == kept[k + 1].from_row;
    fit_ends(maps, end_maps(target, maps.grid, block.from_mm, block.to_mm), {!after, !before},
             block);
    if (block.to_mm - block.from_mm < sizes.length_mm) continue;
    if (after && !out.blocks.empty()) out.touches.back() = true;
    out.blocks.push_back(block);
    out.touches.push_back(false);
  }
  return {out, out.misfit + out.aside_share + kBlockCost * static_cast<double>(out.blocks.size())};
}

}  // namespace

double wall_direction_rad(const TriangleSoup& target) {
  constexpr double kUpright = 0.2;
  std::complex<double> sum;
  for (std::size_t t = 0; t < target.size(); ++t) {
    const Vec3 n = cross(Vec3(target.corner(t, 1) - target.corner(t, 0)),
                         Vec3(target.corner(t, 2) - target.corner(t, 0)));
    const double twice = norm(n);
    if (!(twice > 0.0) || std::abs(n.z()) > kUpright * twice) continue;
    sum += twice * std::polar(1.0, 4.0 * std::atan2(n.y(), n.x()));
  }
  const double at = std::abs(sum) > 0.0 ? 0.25 * std::arg(sum) : 0.0;
  return std::abs(at) < kStraight_rad ? 0.0 : at;
}

void turn_about_z(TriangleSoup& target, double turn_rad) {
  if (turn_rad == 0.0) return;
  const double c = std::cos(turn_rad), s = std::sin(turn_rad);
  std::vector<double>& corners = target.corners;
  for (std::size_t k = 0; k + 2 < corners.size(); k += 3) {
    const double x = corners[k], y = corners[k + 1];
    corners[k] = c * x - s * y, corners[k + 1] = s * x + c * y;
  }
}

BlockRows block_rows(const TriangleSoup& target, const BlockSizes& sizes,
                     const CanStand& can_stand) {
  const double straight = -wall_direction_rad(target);
  BlockRows out;
  std::array<double, 2> least;
  least.fill(std::numeric_limits<double>::infinity());
  for (const double more : {0.0, 0.5 * std::numbers::pi}) {
    TriangleSoup turned = target;
    turn_about_z(turned, straight + more);
    const HeightMaps maps = height_maps(turned, kMapCells);
    StretchFits fits(maps, sizes);
    const auto take = [&](const CanStand& rule, BlockRow& best, double& of) {
      auto [row, cost] = row_along_y(turned, sizes, fits, rule);
      if (row.empty() || cost >= of) return;
      of = cost, best = std::move(row), best.turn_rad = straight + more;
    };
    take({}, out.nearest, least[0]);
    take(can_stand, out.standing, least[1]);
  }
  return out;
}

}  // namespace popcut
