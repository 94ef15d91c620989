// SPDX-License-Identifier: MIT
#include "core/design/layers/layer_masks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <queue>
#include <utility>

#include "core/geometry/interval_medians.hpp"

namespace popcut {
namespace {

constexpr double kLookDown_rad = 0.6;  ///< from how far above what is seen counts for depths
constexpr double kSample_mm2 = 2.0;
constexpr double kShownCost = 8.0;  ///< of paper that is seen, for each of it that is hidden
constexpr std::size_t kMostSamples = 2000;
constexpr double kGusset = 0.25;  ///< height of what holds a foot beyond the shape, for its length

struct Extent {
  Vec3 low, high;
};

Extent extent_of(const TriangleSoup& soup) {
  Extent out{soup.corner(0, 0), soup.corner(0, 0)};
  for (std::size_t t = 0; t < soup.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      out.low = out.low.cwiseMin(soup.corner(t, k));
      out.high = out.high.cwiseMax(soup.corner(t, k));
    }
  return out;
}

/// The cells of one half of a grid, 0 the column beside the middle.
struct Half {
  const LayerGrid& grid;
  bool is_right{};

  [[nodiscard]] std::size_t columns() const { return grid.columns / 2; }
  [[nodiscard]] std::size_t cell(std::size_t column, std::size_t row) const {
    return grid.at(is_right ? columns() + column : columns() - 1 - column, row);
  }
  [[nodiscard]] std::size_t size() const { return columns() * grid.rows; }
};

/// The four neighbours of a cell of a half, by index in it.
template <typename Each>
void each_beside(const Half& half, std::size_t at, Each each) {
  const std::size_t columns = half.columns(), c = at % columns, r = at / columns;
  if (c > 0) each(at - 1);
  if (c + 1 < columns) each(at + 1);
  if (r > 0) each(at - columns);
  if (r + 1 < half.grid.rows) each(at + columns);
}

LayerMask half_of(const Half& half, const LayerMask& mask) {
  LayerMask out(half.size());
  for (std::size_t k = 0; k < out.size(); ++k)
    out[k] = mask[half.cell(k % half.columns(), k / half.columns())];
  return out;
}

/// Numbers the parts of a half from 1 on; 0 where there is no paper.
std::vector<std::uint32_t> parts_of(const Half& half, const LayerMask& mask, std::uint8_t what,
                                    std::vector<std::size_t>& sizes) {
  std::vector<std::uint32_t> part(half.size(), 0);
  std::vector<std::size_t> open;
  for (std::size_t k = 0; k < part.size(); ++k) {
    if (mask[k] != what || part[k] != 0) continue;
    sizes.push_back(0);
    part[k] = static_cast<std::uint32_t>(sizes.size());
    open.push_back(k);
    while (!open.empty()) {
      const std::size_t at = open.back();
      open.pop_back();
      ++sizes.back();
      each_beside(half, at, [&](std::size_t to) {
        if (mask[to] == what && part[to] == 0) part[to] = part[at], open.push_back(to);
      });
    }
  }
  return part;
}

/// Makes one half one piece.
class HalfMaker {
 public:
  /// @param high    rows of the layer
  /// @param covered  rows of its middle that layers in front hide
  HalfMaker(const LayerGrid& grid, bool is_right, const LayerMask& hidden, const LayerPaper& paper,
            std::size_t high, std::size_t covered, LayerMask& whole, LayerChanges& changes)
      : half_{grid, is_right},
        paper_(paper),
        high_(high),
        covered_(covered),
        whole_(whole),
        changes_(changes),
        mask_(half_of(half_, whole)),
        hidden_(half_of(half_, hidden)) {}

  void run() {
    smooth();
    open_thin();
    drop_small();
    if (!paper_.may_miss_half || std::find(mask_.begin(), mask_.end(), 1) != mask_.end()) stand();
    for (std::size_t k = 0; k < mask_.size(); ++k)
      whole_[half_.cell(k % half_.columns(), k / half_.columns())] = mask_[k];
  }

 private:
  void stand() {
    add_foot();
    while (join_nearest()) {
    }
    if (paper_.ridge_mm > 0.0) clear_fold();
    fill_holes();
    while (fill_corners(half_.columns(), mask_)) fill_holes();
  }

  [[nodiscard]] std::size_t cells(double mm) const {
    return static_cast<std::size_t>(std::max(1.0, std::round(mm / half_.grid.cell_mm)));
  }
  [[nodiscard]] double area_mm2(std::size_t count) const {
    return static_cast<double>(count) * half_.grid.cell_mm * half_.grid.cell_mm;
  }

  /// Takes the majority of what is around each cell: stairs and nicks go. Beyond the middle and the
  /// page it is as beside them.
  void smooth() {
    constexpr std::ptrdiff_t kReach = 2;
    const auto columns = static_cast<std::ptrdiff_t>(half_.columns()),
               rows = static_cast<std::ptrdiff_t>(half_.grid.rows);
    LayerMask out(mask_.size(), 0);
    for (std::ptrdiff_t r = 0; r < rows; ++r)
      for (std::ptrdiff_t c = 0; c < columns; ++c) {
        int paper = 0;
        for (std::ptrdiff_t dr = -kReach; dr <= kReach; ++dr)
          for (std::ptrdiff_t dc = -kReach; dc <= kReach; ++dc) {
            const std::ptrdiff_t y = std::max<std::ptrdiff_t>(0, r + dr),
                                 x = std::max<std::ptrdiff_t>(0, c + dc);
            if (y < rows && x < columns) paper += mask_[static_cast<std::size_t>(y * columns + x)];
          }
        constexpr int kHalf = (2 * kReach + 1) * (2 * kReach + 1) / 2;
        out[static_cast<std::size_t>(r * columns + c)] = paper > kHalf ? 1 : 0;
      }
    mask_ = std::move(out);
  }

  /// Takes out what is thinner than two cells; the middle and the page go on.
  void open_thin() {
    const auto all_of_square = [&](const LayerMask& from, std::size_t c, std::size_t r) {
      return from[r * half_.columns() + c] != 0 && from[r * half_.columns() + c + 1] != 0 &&
             from[(r + 1) * half_.columns() + c] != 0 &&
             from[(r + 1) * half_.columns() + c + 1] != 0;
    };
    LayerMask out(mask_.size(), 0);
    for (std::size_t r = 0; r + 1 < half_.grid.rows; ++r)
      for (std::size_t c = 0; c + 1 < half_.columns(); ++c)
        if (all_of_square(mask_, c, r))
          for (const std::size_t k : {std::size_t{0}, std::size_t{1}})
            out[r * half_.columns() + c + k] = out[(r + 1) * half_.columns() + c + k] = 1;
    mask_ = std::move(out);
  }

  void drop_small() {
    std::vector<std::size_t> sizes;
    const auto part = parts_of(half_, mask_, 1, sizes);
    for (std::size_t k = 0; k < mask_.size(); ++k)
      if (part[k] != 0 && area_mm2(sizes[part[k] - 1]) < paper_.least_mm2) mask_[k] = 0;
    changes_.dropped +=
        static_cast<std::size_t>(std::count_if(sizes.begin(), sizes.end(), [&](std::size_t size) {
          return area_mm2(size) < paper_.least_mm2;
        }));
  }

  /// The strip at the foot, and paper on both sides of the fold in the middle.
  void add_foot() {
    const std::size_t low_rows = std::min(half_.grid.rows, cells(2.5 * paper_.band_mm));
    std::size_t widest = 0, low = 0;
    for (std::size_t k = 0; k < mask_.size(); ++k) {
      if (mask_[k] == 0) continue;
      widest = std::max(widest, k % half_.columns() + 1);
      if (k / half_.columns() < low_rows) low = std::max(low, k % half_.columns() + 1);
    }
    const auto share = [&](double of) {
      return static_cast<std::size_t>(of * static_cast<double>(high_));
    };
    const double firm =
        std::min(paper_.firm_foot_mm / half_.grid.cell_mm, static_cast<double>(half_.columns()));
    const std::size_t within = std::min(
        {half_.columns(), cells(paper_.widest_foot_mm),
         std::max({low, widest / 2, cells(paper_.least_foot_mm), share(paper_.foot_share)})});
    const std::size_t foot = std::max(within, static_cast<std::size_t>(std::ceil(firm)));
    fill(0, foot, 0, cells(paper_.band_mm));
    // Where it is longer than that, it is a gusset, since a long strip alone bends.
    for (std::size_t c = low; foot > within && c < foot; ++c)
      fill(c, c + 1, 0,
           cells(paper_.band_mm + kGusset * half_.grid.cell_mm * static_cast<double>(foot - c)));
    // Who looks from above sees a little over what hides the fold.
    const std::size_t hidden = covered_ - std::min(covered_, cells(2.0 * paper_.band_mm));
    const std::size_t ridge = std::max({cells(paper_.ridge_mm), share(paper_.ridge_share),
                                        std::min(hidden, share(paper_.hidden_share))});
    for (std::size_t r = 0; r < std::min(ridge, half_.grid.rows); ++r)
      fill(0, std::max<std::size_t>(2, foot * (ridge - r) / (2 * ridge)), r, r + 1);
  }
  void fill(std::size_t from, std::size_t to, std::size_t row, std::size_t end) {
    for (std::size_t r = row; r < std::min(end, half_.grid.rows); ++r)
      for (std::size_t c = from; c < std::min(to, half_.columns()); ++c)
        mask_[r * half_.columns() + c] = 1;
  }

  /// Joins the part that costs least to the piece that stands on the page. Whether there was one.
  bool join_nearest() {
    std::vector<std::size_t> sizes;
    const auto part = parts_of(half_, mask_, 1, sizes);
    if (sizes.size() < 2) return false;
    const std::uint32_t main = part[0];  // the foot
    std::vector<float> cost(mask_.size(), std::numeric_limits<float>::infinity());
    std::vector<std::size_t> from(mask_.size(), mask_.size());
    using Step = std::pair<float, std::size_t>;
    std::priority_queue<Step, std::vector<Step>, std::greater<>> open;
    for (std::size_t k = 0; k < mask_.size(); ++k)
      if (part[k] == main) cost[k] = 0.0F, open.emplace(0.0F, k);
    while (!open.empty()) {
      const float so_far = open.top().first;
      const std::size_t at = open.top().second;
      open.pop();
      if (so_far > cost[at]) continue;
      if (part[at] != 0 && part[at] != main) {
        lay_bridge(from, at);
        ++changes_.bridges;
        return true;
      }
      each_beside(half_, at, [&](std::size_t to) {
        const float next = so_far + (mask_[to] != 0     ? 0.0F
                                     : hidden_[to] != 0 ? 1.0F
                                                        : static_cast<float>(kShownCost));
        if (next < cost[to]) cost[to] = next, from[to] = at, open.emplace(next, to);
      });
    }
    return false;
  }

  void lay_bridge(const std::vector<std::size_t>& from, std::size_t end) {
    const auto reach = static_cast<std::ptrdiff_t>(cells(0.5 * paper_.bridge_mm));
    const auto columns = static_cast<std::ptrdiff_t>(half_.columns()),
               rows = static_cast<std::ptrdiff_t>(half_.grid.rows);
    std::size_t shown = 0;
    for (std::size_t at = end; at < mask_.size(); at = from[at]) {
      const auto c = static_cast<std::ptrdiff_t>(at) % columns,
                 r = static_cast<std::ptrdiff_t>(at) / columns;
      for (std::ptrdiff_t dr = -reach; dr <= reach; ++dr)
        for (std::ptrdiff_t dc = -reach; dc <= reach; ++dc) {
          if (c + dc < 0 || c + dc >= columns || r + dr < 0 || r + dr >= rows) continue;
          const auto k = static_cast<std::size_t>((r + dr) * columns + c + dc);
          shown += mask_[k] == 0 && hidden_[k] == 0 ? 1 : 0;
          mask_[k] = 1;
        }
    }
    changes_.shown_mm2 += area_mm2(shown);
  }

  /// Leaves no slot at the fold in the middle that is too narrow to cut, and no fold that is too
  /// short to crease.
  void clear_fold() {
    constexpr double kSlot_mm = 2.0, kFold_mm = 4.0;  // on each side of the middle; along it
    const std::size_t near = std::min(cells(kSlot_mm), half_.columns()), rows = half_.grid.rows;
    const auto begins = [&](std::size_t row) {
      const auto first = mask_.begin() + static_cast<std::ptrdiff_t>(row * half_.columns());
      return static_cast<std::size_t>(
          std::find(first, first + static_cast<std::ptrdiff_t>(near), 1) - first);
    };
    for (std::size_t r = 0; r < rows; ++r)
      if (const std::size_t c = begins(r); c < near) fill(0, c, r, r + 1);
    // Beside a fold there is no paper so near to the middle, so nothing hangs on what is taken out.
    for (std::size_t r = 0; r < rows;) {
      const std::size_t from = r;
      while (r < rows && begins(r) == 0) ++r;
      if (from > 0 && r > from && r - from < cells(kFold_mm))
        for (std::size_t row = from; row < r; ++row)
          std::fill_n(mask_.begin() + static_cast<std::ptrdiff_t>(row * half_.columns()), near, 0);
      if (r == from) ++r;
    }
  }

  /// Fills small holes. A gap at the middle is no hole: the fold stops there.
  void fill_holes() {
    std::vector<std::size_t> sizes;
    const auto part = parts_of(half_, mask_, 0, sizes);
    std::vector<bool> is_open(sizes.size(), false);
    for (std::size_t k = 0; k < mask_.size(); ++k) {
      const std::size_t c = k % half_.columns(), r = k / half_.columns();
      if (part[k] != 0 &&
          (c == 0 || c + 1 == half_.columns() || r == 0 || r + 1 == half_.grid.rows))
        is_open[part[k] - 1] = true;
    }
    for (std::size_t n = 0; n < sizes.size(); ++n)
      is_open[n] = is_open[n] || area_mm2(sizes[n]) >= paper_.least_mm2;
    for (std::size_t k = 0; k < mask_.size(); ++k)
      if (part[k] != 0 && !is_open[part[k] - 1]) mask_[k] = 1;
    changes_.filled += static_cast<std::size_t>(std::count(is_open.begin(), is_open.end(), false));
  }

  Half half_;
  const LayerPaper& paper_;
  std::size_t high_, covered_;
  LayerMask& whole_;
  LayerChanges& changes_;
  LayerMask mask_, hidden_;
};

/// Moves ascending places as little as puts each `apart` behind the last, from 0 to `end`: without
/// the distances they must not fall, and what falls becomes the mean of its run (pool adjacent
/// violators).
std::vector<double> spread(std::vector<double> places, double apart, double end) {
  struct Run {
    double sum{};
    std::size_t count{};
    [[nodiscard]] double mean() const { return sum / static_cast<double>(count); }
  };
  std::vector<Run> runs;
  for (std::size_t k = 0; k < places.size(); ++k) {
    runs.push_back({places[k] - apart * static_cast<double>(k), 1});
    while (runs.size() > 1 && runs[runs.size() - 2].mean() > runs.back().mean()) {
      const Run last = runs.back();
      runs.pop_back();
      runs.back().sum += last.sum, runs.back().count += last.count;
    }
  }
  const double most = std::max(0.0, end - apart * static_cast<double>(places.size() - 1));
  std::size_t k = 0;
  for (const Run& run : runs)
    for (std::size_t n = 0; n < run.count; ++n, ++k)
      places[k] = std::clamp(run.mean(), 0.0, most) + apart * static_cast<double>(k);
  return places;
}

using Stretches = std::vector<std::pair<double, double>>;

/// Where a ray is inside: in one solid or in several that overlap. Surfaces that do not say by
/// their direction which side is inside are counted: inside after each odd one. What is not closed
/// counts as solid from its first surface to the back.
Stretches inside_stretches(const std::vector<DepthCrossing>& at) {
  Stretches out;
  int deep = 0;
  bool is_directed = true;
  for (const DepthCrossing& one : at) {
    if (one.enters && deep == 0) out.emplace_back(one.depth_mm, one.depth_mm);
    deep += one.enters ? 1 : -1;
    is_directed = is_directed && deep >= 0;
    if (is_directed && deep == 0) out.back().second = one.depth_mm;
  }
  if (is_directed && deep == 0) return out;
  out.clear();
  if (at.size() % 2 == 1) return {{at.front().depth_mm, std::numeric_limits<double>::infinity()}};
  for (std::size_t k = 0; k < at.size(); k += 2)
    out.emplace_back(at[k].depth_mm, at[k + 1].depth_mm);
  return out;
}

}  // namespace

DepthStacks depth_stacks(TriangleSoup target, const LayerLook& look, double cell_mm,
                         double least_half_mm) {
  const double front = extent_of(target).high.x();
  for (std::size_t k = 0; k < target.corners.size(); k += 3)
    target.corners[k + 2] += look.fall * (front - target.corners[k]);
  const Extent box = extent_of(target);
  DepthStacks out;
  out.look = look;
  LayerGrid& grid = out.grid;
  grid.cell_mm = cell_mm;
  const double half = std::max({std::abs(box.low.y()), std::abs(box.high.y()), least_half_mm});
  grid.columns = 2 * (static_cast<std::size_t>(std::ceil(half / cell_mm)) + 2);
  grid.rows = static_cast<std::size_t>(std::ceil(std::max(box.high.z(), 20.0) / cell_mm)) + 2;
  out.crossings.resize(grid.cells());
  // Off the middles of cells by a little, so that no ray runs along an edge.
  constexpr double kAside = 0.0137;
  const double y0 = -0.5 * cell_mm * static_cast<double>(grid.columns) + kAside * cell_mm,
               z0 = kAside * 1.7 * cell_mm;
  const auto first = [&](double mm, double origin, std::size_t most) {
    return static_cast<std::size_t>(
        std::clamp(std::ceil((mm - origin) / cell_mm - 0.5), 0.0, static_cast<double>(most)));
  };
  for (std::size_t t = 0; t < target.size(); ++t) {
    const Vec3 a = target.corner(t, 0), u = target.corner(t, 1) - a, w = target.corner(t, 2) - a;
    const double twice = u.y() * w.z() - u.z() * w.y();
    if (twice == 0.0) continue;
    const auto [low_y, high_y] = std::minmax({0.0, u.y(), w.y()});
    const auto [low_z, high_z] = std::minmax({0.0, u.z(), w.z()});
    for (std::size_t r = first(a.z() + low_z, z0, grid.rows);
         r < first(a.z() + high_z, z0, grid.rows); ++r)
      for (std::size_t c = first(a.y() + low_y, y0, grid.columns);
           c < first(a.y() + high_y, y0, grid.columns); ++c) {
        const double y = y0 + (static_cast<double>(c) + 0.5) * cell_mm - a.y(),
                     z = z0 + (static_cast<double>(r) + 0.5) * cell_mm - a.z();
        const double p = (y * w.z() - z * w.y()) / twice, q = (z * u.y() - y * u.z()) / twice;
        if (p < 0.0 || q < 0.0 || p + q > 1.0) continue;
        const double x = a.x() + p * u.x() + q * w.x();
        const double depth = front - x - look.behind_mm(y + a.y());
        out.crossings[grid.at(c, r)].push_back({static_cast<float>(depth), twice > 0.0});
      }
  }
  for (auto& one : out.crossings)
    std::sort(one.begin(), one.end(), [](const DepthCrossing& a, const DepthCrossing& b) {
      return a.depth_mm < b.depth_mm || (a.depth_mm == b.depth_mm && a.enters && !b.enters);
    });
  return out;
}

bool fill_corners(std::size_t columns, LayerMask& mask) {
  bool any = false;
  for (std::size_t next = columns; next < mask.size(); next += columns)
    for (std::size_t c = 0; c + 1 < columns; ++c) {
      std::uint8_t &a = mask[next - columns + c], &b = mask[next - columns + c + 1],
                   &d = mask[next + c], &e = mask[next + c + 1];
      if (a == e && b == d && a != b) a = b = d = e = 1, any = true;
    }
  return any;
}

double height_of(const LayerGrid& grid, const LayerMask& mask) {
  // Rows lie one after another, the lowest first.
  const auto last = std::find_if(mask.rbegin(), mask.rend(), [](auto paper) { return paper != 0; });
  const auto cells = static_cast<std::size_t>(mask.rend() - last);
  const std::size_t rows = (cells + grid.columns - 1) / grid.columns;
  return static_cast<double>(rows) * grid.cell_mm;
}

std::vector<double> layer_depths(const TriangleSoup& target, int count, double apart_mm) {
  const Extent box = extent_of(target);
  double volume = 0.0;
  for (std::size_t t = 0; t < target.size(); ++t)
    volume += dot(target.corner(t, 0), cross(target.corner(t, 1), target.corner(t, 2)));
  const double outward = volume < 0.0 ? -1.0 : 1.0;
  const Vec3 toward{std::cos(kLookDown_rad), 0.0, std::sin(kLookDown_rad)};
  std::map<int, double> seen;
  for (std::size_t t = 0; t < target.size(); ++t) {
    const Vec3 a = target.corner(t, 0), u = target.corner(t, 1) - a, w = target.corner(t, 2) - a;
    const double area = 0.5 * outward * dot(cross(u, w), toward);
    if (!(area > 0.0)) continue;
    const auto each = static_cast<std::size_t>(
        std::clamp(std::sqrt(area / kSample_mm2), 1.0, std::sqrt(kMostSamples)));
    for (std::size_t i = 0; i < each; ++i)
      for (std::size_t j = 0; j < each; ++j) {
        double p = (static_cast<double>(i) + 0.5) / static_cast<double>(each),
               q = (static_cast<double>(j) + 0.5) / static_cast<double>(each);
        if (p + q > 1.0) p = 1.0 - p, q = 1.0 - q;
        const double x = a.x() + p * u.x() + q * w.x();
        seen[static_cast<int>(std::llround(box.high.x() - x))] +=
            area / static_cast<double>(each * each);
      }
  }
  const double deep_mm = box.high.x() - box.low.x();
  const int most = std::min(count, 1 + static_cast<int>(deep_mm / apart_mm));
  std::vector<double> out;
  for (const int depth : interval_medians(seen, most)) out.push_back(depth);
  std::reverse(out.begin(), out.end());
  return spread(std::move(out), apart_mm, deep_mm);
}

std::vector<LayerMask> layer_masks(const DepthStacks& stacks,
                                   const std::vector<double>& depths_mm) {
  const LayerGrid& grid = stacks.grid;
  std::vector<LayerMask> out(depths_mm.size(), LayerMask(grid.cells(), 0));
  constexpr double kFar = std::numeric_limits<double>::infinity();
  std::vector<Stretches> inside;
  for (const std::vector<DepthCrossing>& at : stacks.crossings)
    inside.push_back(inside_stretches(at));
  for (std::size_t j = 0; j < out.size(); ++j) {
    const double from = j == 0 ? -kFar : 0.5 * (depths_mm[j - 1] + depths_mm[j]),
                 to = j + 1 == out.size() ? kFar : 0.5 * (depths_mm[j] + depths_mm[j + 1]);
    for (std::size_t c = 0; c < grid.columns; ++c) {
      const double aside =
          (static_cast<double>(c) + 0.5 - 0.5 * static_cast<double>(grid.columns)) * grid.cell_mm;
      const auto fallen = static_cast<std::ptrdiff_t>(std::llround(
          stacks.look.fall *
          (depths_mm[j] + (1.0 - stacks.look.raised_share(j)) * stacks.look.behind_mm(aside)) /
          grid.cell_mm));
      const auto rows = static_cast<std::ptrdiff_t>(grid.rows);
      for (std::ptrdiff_t r = std::max<std::ptrdiff_t>(0, fallen);
           r < rows + std::min<std::ptrdiff_t>(0, fallen); ++r)
        for (const auto& [first, last] : inside[grid.at(c, static_cast<std::size_t>(r))])
          if (first < to && last >= from)
            out[j][grid.at(c, static_cast<std::size_t>(r - fallen))] = 1;
    }
  }
  return out;
}

LayerPaper unfolded_paper() {
  LayerPaper out;
  out.least_foot_mm = 11.0, out.foot_share = 0.2;
  out.ridge_mm = out.ridge_share = out.hidden_share = 0.0;
  out.may_miss_half = true;
  return out;
}

LayerChanges make_one_piece(const LayerGrid& grid, const LayerMask& hidden, const LayerPaper& paper,
                            LayerMask& mask) {
  LayerChanges out;
  std::size_t high = 0, covered = 0;
  for (std::size_t k = 0; k < mask.size(); ++k)
    if (mask[k] != 0) high = std::max(high, k / grid.columns + 1);
  const std::size_t middle = grid.columns / 2;
  while (covered < grid.rows && hidden[grid.at(middle - 1, covered)] != 0 &&
         hidden[grid.at(middle, covered)] != 0)
    ++covered;
  for (const bool is_right : {false, true})
    HalfMaker(grid, is_right, hidden, paper, high, covered, mask, out).run();
  return out;
}

}  // namespace popcut
