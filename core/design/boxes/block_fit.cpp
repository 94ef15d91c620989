// SPDX-License-Identifier: MIT
#include "core/design/boxes/block_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

namespace popcut {
namespace {

constexpr double kPlane = 0.012;      ///< of the height: places within it lie in one wall
constexpr double kLeastWall = 0.2;    ///< of the height: a lower wall is none
constexpr double kBetterRoof = 0.7;   ///< of the flat one's misfit, that a sloped roof must reach
constexpr double kLeastPitch = 0.12;  ///< of a sloped roof: rise over half width
constexpr double kFarEnd = 0.25;      ///< of a block's length: so near its end its wall must be
constexpr double kRoofWithin = 0.06;  ///< of the height: what is nearer to a roof is part of it

/// The middle one of some values, which are put in another order. Its comparison is a type of its
/// own: a build for tests optimises this folder, and must not take `nth_element` from another one.
double median_within(std::vector<double>& of) {
  if (of.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto middle = of.begin() + static_cast<std::ptrdiff_t>(of.size() / 2);
  std::nth_element(of.begin(), middle, of.end(), [](double a, double b) { return a < b; });
  return *middle;
}
double median(std::vector<double> of) { return median_within(of); }

/// The stretch of `width` that most of some places lie in: how many, and their median.
struct Mode {
  double at{};
  std::size_t count{};
};
Mode mode_of(std::vector<double> places, double width) {
  std::sort(places.begin(), places.end());
  Mode out;
  std::size_t first = 0;
  for (std::size_t last = 0; last < places.size(); ++last) {
    while (places[last] - places[first] > width) ++first;
    if (last + 1 - first > out.count) out = {places[(first + last) / 2], last + 1 - first};
  }
  return out;
}

struct Rows {
  std::size_t from{}, to{};
};

double highest(const HeightMaps& maps, Rows rows) {
  const std::size_t n = maps.grid.columns;
  return *std::max_element(maps.top.begin() + static_cast<std::ptrdiff_t>(rows.from * n),
                           maps.top.begin() + static_cast<std::ptrdiff_t>(rows.to * n));
}

/// Where most of the sides of some rows lie, level by level; `levels` of them there.
Mode wall_of(const HeightMaps& maps, Rows rows, bool is_right, double high) {
  const std::size_t n = maps.grid.levels;
  std::vector<double> planes;
  for (std::size_t level = 0; level < n && maps.grid.z_of(level) < high; ++level) {
    std::vector<double> at;
    for (std::size_t row = rows.from; row < rows.to; ++row)
      if (const double x = (is_right ? maps.right : maps.left)[row * n + level]; !std::isnan(x))
        at.push_back(x);
    if (2 * at.size() > rows.to - rows.from) planes.push_back(median(std::move(at)));
  }
  return mode_of(std::move(planes), std::max(kPlane * high, maps.grid.cell_mm));
}

/// How far a place lies from the top or the ridge of a roof (0) to its walls (1).
double down_roof(const Block& block, BlockRoof roof, double x, double y) {
  const double across = std::abs(x - block.middle_mm) / block.half_mm;
  if (roof == BlockRoof::Gabled) return across;
  const double along =
      std::abs(y - 0.5 * (block.from_mm + block.to_mm)) / (0.5 * (block.to_mm - block.from_mm));
  return std::max(across, along);
}

struct RoofFit {
  double height{}, rise{}, misfit{};  ///< misfit: mean distance, of all places
};

/// Height and rise of a roof over places inside the walls: least squares, in which places that are
/// far off count less and less (Cauchy weights).
RoofFit fit_roof(const HeightMaps& maps, Rows rows, const Block& block, BlockRoof roof) {
  constexpr std::size_t kMostPlaces = 3000;
  constexpr int kRounds = 12;
  constexpr double kSettled = 1e-4;  // of the height: finer than any cell
  const BlockGrid& grid = maps.grid;
  const double cells =
      2.0 * block.half_mm / grid.cell_mm * static_cast<double>(rows.to - rows.from);
  const auto step = std::max<std::size_t>(
      1, static_cast<std::size_t>(std::sqrt(cells / static_cast<double>(kMostPlaces))));
  std::vector<std::array<double, 2>> places;  // up the roof, height
  for (std::size_t row = rows.from; row < rows.to; row += step)
    for (std::size_t column = 0; column < grid.columns; column += step) {
      if (std::abs(grid.x_of(column) - block.middle_mm) >= block.half_mm) continue;
      const double up = 1.0 - down_roof(block, roof, grid.x_of(column), grid.y_of(row));
      if (up > 0.0 && maps.top_at(row, column) > 0.0)
        places.push_back({roof == BlockRoof::Flat ? 0.0 : up, maps.top_at(row, column)});
    }
  RoofFit out;
  if (places.size() < 4) return {0.0, 0.0, std::numeric_limits<double>::infinity()};
  std::vector<double> sorted;
  sorted.reserve(places.size());
  for (const auto& place : places) sorted.push_back(place[1]);
  const double middle = median_within(sorted);
  out.height = middle;
  std::vector<double> off(places.size(), 0.0);
  double scale = std::numeric_limits<double>::infinity();
  for (int round = 0; round < kRounds; ++round) {
    const RoofFit before = out;
    double w0 = 0.0, w1 = 0.0, w2 = 0.0, h0 = 0.0, h1 = 0.0;
    for (std::size_t k = 0; k < places.size(); ++k) {
      const double r = off[k] / scale, w = 1.0 / (1.0 + r * r);
      const auto& [t, h] = places[k];
      w0 += w, w1 += w * t, w2 += w * t * t, h0 += w * h, h1 += w * t * h;
    }
    const double det = w0 * w2 - w1 * w1;
    if (roof == BlockRoof::Flat || !(det > 1e-12 * w0 * w0)) {
      out.height = h0 / w0;
    } else {
      out.height = (h0 * w2 - h1 * w1) / det;
      out.rise = (w0 * h1 - w1 * h0) / det;
    }
    out.misfit = 0.0;
    for (std::size_t k = 0; k < places.size(); ++k) {
      off[k] = std::abs(places[k][1] - out.height - out.rise * places[k][0]);
      out.misfit += off[k] / static_cast<double>(places.size());
    }
    const double moved = std::abs(out.height - before.height) + std::abs(out.rise - before.rise);
    if (round > 0 && moved < kSettled * middle) break;
    sorted = off;
    scale = std::max(2.0 * median_within(sorted), 1e-3 * middle);
  }
  return out;
}

void take_best_roof(const HeightMaps& maps, Rows rows, bool may_be_pyramid, Block& block) {
  const RoofFit flat = fit_roof(maps, rows, block, BlockRoof::Flat);
  block.roof = BlockRoof::Flat, block.height_mm = flat.height, block.rise_mm = 0.0;
  double best = kBetterRoof * flat.misfit;
  for (const BlockRoof roof : {BlockRoof::Gabled, BlockRoof::Pyramid}) {
    if (roof == BlockRoof::Pyramid && !may_be_pyramid) continue;
    const RoofFit sloped = fit_roof(maps, rows, block, roof);
    if (sloped.misfit >= best || sloped.rise < kLeastPitch * block.half_mm) continue;
    best = sloped.misfit;
    block.roof = roof, block.height_mm = sloped.height, block.rise_mm = sloped.rise;
  }
}

/// How far rows reach across, median of both sides.
std::array<double, 2> extent_of(const HeightMaps& maps, Rows rows, double above) {
  std::vector<double> low, high;
  for (std::size_t row = rows.from; row < rows.to; ++row) {
    std::size_t first = maps.grid.columns, last = 0;
    for (std::size_t column = 0; column < maps.grid.columns; ++column)
      if (maps.top_at(row, column) > above) first = std::min(first, column), last = column;
    if (first > last) continue;
    low.push_back(maps.grid.x_of(first) - 0.5 * maps.grid.cell_mm);
    high.push_back(maps.grid.x_of(last) + 0.5 * maps.grid.cell_mm);
  }
  return {median(std::move(low)), median(std::move(high))};
}

/// How far a gabled roof goes on beyond its walls, down its slope.
double eaves_of(const HeightMaps& maps, Rows rows, const Block& block) {
  const double slope = block.rise_mm / block.half_mm, within = kRoofWithin * block.top_mm();
  std::array<double, 2> reach{block.half_mm, block.half_mm};
  for (std::size_t column = 0; column < maps.grid.columns; ++column) {
    const double x = maps.grid.x_of(column) - block.middle_mm, far = std::abs(x);
    if (far < block.half_mm) continue;
    std::vector<double> heights;
    for (std::size_t row = rows.from; row < rows.to; ++row)
      heights.push_back(maps.top_at(row, column));
    const double roof = block.top_mm() - slope * far;
    if (roof > within && std::abs(median(std::move(heights)) - roof) < within) {
      double& side = reach[x > 0.0 ? 1 : 0];
      side = std::max(side, far + 0.5 * maps.grid.cell_mm);
    }
  }
  const double beyond = 0.5 * (reach[0] + reach[1]) - block.half_mm;
  return beyond <= maps.grid.cell_mm ? 0.0 : beyond * std::hypot(1.0, slope);
}

}  // namespace

double Block::height_at(double x_mm, double y_mm) const {
  if (y_mm < from_mm - verge_mm[0] || y_mm > to_mm + verge_mm[1]) return 0.0;
  if (half_mm <= 0.0) return 0.0;
  const double eaves = rise_mm > 0.0 ? eaves_mm / std::hypot(1.0, rise_mm / half_mm) : 0.0;
  if (std::abs(x_mm - middle_mm) > half_mm + eaves) return 0.0;
  if (roof == BlockRoof::Flat) return height_mm;
  return height_mm + rise_mm * (1.0 - down_roof(*this, roof, x_mm, y_mm));
}

double volume_of(const HeightMaps& maps, std::size_t from_row, std::size_t to_row) {
  const auto first = maps.top.begin() + static_cast<std::ptrdiff_t>(from_row * maps.grid.columns),
             last = maps.top.begin() + static_cast<std::ptrdiff_t>(to_row * maps.grid.columns);
  return std::accumulate(first, last, 0.0) * maps.grid.cell_mm * maps.grid.cell_mm;
}

double misfit_of(const HeightMaps& maps, std::size_t from_row, std::size_t to_row,
                 const Block& block) {
  double sum = 0.0;
  for (std::size_t row = from_row; row < to_row; ++row)
    for (std::size_t column = 0; column < maps.grid.columns; ++column)
      sum += std::abs(maps.top_at(row, column) -
                      block.height_at(maps.grid.x_of(column), maps.grid.y_of(row)));
  return sum * maps.grid.cell_mm * maps.grid.cell_mm;
}

std::optional<BlockMisfit> fit_block(const HeightMaps& maps, std::size_t from_row,
                                     std::size_t to_row, const BlockSizes& sizes,
                                     bool may_be_pyramid) {
  const Rows rows{from_row, to_row};
  const double cell = maps.grid.cell_mm;
  Block block;
  block.from_mm = maps.grid.y_of(from_row) - 0.5 * cell;
  block.to_mm = maps.grid.y_of(to_row) - 0.5 * cell;
  if (block.to_mm - block.from_mm < sizes.length_mm) return std::nullopt;
  const double high = highest(maps, rows);
  if (high < sizes.height_mm) return std::nullopt;
  const Mode left = wall_of(maps, rows, false, high), right = wall_of(maps, rows, true, high);
  const auto enough = static_cast<std::size_t>(std::ceil(kLeastWall * high / cell));
  const bool has_walls =
      left.count >= enough && right.count >= enough && right.at - left.at >= 2.0 * sizes.half_mm;
  std::array<double, 2> sides{left.at, right.at};
  if (!has_walls) sides = extent_of(maps, rows, 0.05 * high);
  block.middle_mm = 0.5 * (sides[0] + sides[1]);
  block.half_mm = 0.5 * (sides[1] - sides[0]);
  if (!(block.half_mm >= sizes.half_mm)) return std::nullopt;
  take_best_roof(maps, rows, may_be_pyramid, block);
  if (!has_walls || block.height_mm < sizes.height_mm) {
    // A roof alone: its slopes go on to the ground.
    if (block.roof != BlockRoof::Gabled || block.rise_mm < sizes.tent_mm ||
        std::abs(block.height_mm) > std::max(sizes.height_mm, 0.2 * block.rise_mm))
      return std::nullopt;
    block.half_mm *= block.top_mm() / block.rise_mm;
    block.rise_mm = block.top_mm(), block.height_mm = 0.0;
  } else if (block.roof == BlockRoof::Gabled) {
    block.eaves_mm = eaves_of(maps, rows, block);
  }
  return BlockMisfit{block, misfit_of(maps, from_row, to_row, block)};
}

void fit_ends(const HeightMaps& maps, const EndMaps& ends, std::array<bool, 2> is_free,
              Block& block) {
  const BlockGrid& grid = maps.grid;
  const double length = block.to_mm - block.from_mm;
  for (const std::size_t end : {0U, 1U}) {
    if (!is_free[end]) continue;
    std::vector<double> walls, roofs;
    for (std::size_t column = 0; column < grid.columns; ++column) {
      if (std::abs(grid.x_of(column) - block.middle_mm) > 0.95 * block.half_mm) continue;
      for (std::size_t level = 0; level < grid.levels && grid.z_of(level) < block.height_mm;
           ++level) {
        const double y = (end == 0 ? ends.first : ends.last)[level * grid.columns + column];
        if (!std::isnan(y)) walls.push_back(y);
      }
      // From the end inward: where the roof begins.
      for (std::size_t k = 0; k < grid.rows; ++k) {
        const std::size_t row = end == 0 ? k : grid.rows - 1 - k;
        const double y = grid.y_of(row);
        if (y < block.from_mm - grid.cell_mm || y > block.to_mm + grid.cell_mm) continue;
        const double roof =
            block.height_at(grid.x_of(column), std::clamp(y, block.from_mm, block.to_mm));
        if (std::abs(maps.top_at(row, column) - roof) > kRoofWithin * block.top_mm()) continue;
        roofs.push_back(end == 0 ? y - 0.5 * grid.cell_mm : y + 0.5 * grid.cell_mm);
        break;
      }
    }
    double& at = end == 0 ? block.from_mm : block.to_mm;
    const double sign = end == 0 ? -1.0 : 1.0, roof = roofs.empty() ? at : median(roofs);
    const Mode wall = mode_of(walls, std::max(kPlane * length, grid.cell_mm));
    const bool has_wall = !block.is_tent() && 4 * wall.count > walls.size() &&
                          std::abs(wall.at - roof) < kFarEnd * length;
    at = has_wall ? wall.at : roof;
    const double beyond = sign * (roof - at);
    block.verge_mm[end] =
        block.roof == BlockRoof::Gabled && !block.is_tent() && beyond > grid.cell_mm ? beyond : 0.0;
  }
}

}  // namespace popcut
