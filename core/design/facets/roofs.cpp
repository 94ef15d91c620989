// SPDX-License-Identifier: MIT
#include "core/design/facets/roofs.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "core/geometry/angle.hpp"
#include "core/hands/wobble.hpp"

namespace popcut {
namespace {

constexpr std::size_t kMostRoofs = 6;
constexpr double kFlattest_rad = radians(8.0), kSteepest_rad = radians(82.0);
constexpr double kAlongSpine = 0.05;  ///< of a normal
constexpr double kSameSlope_rad = radians(1.5), kSamePlane_mm = 1.0;
constexpr double kLeastRoof_mm2 = 100.0, kLeastLength_mm = 6.0;
constexpr double kSeen_mm = 1.5, kSeenShare = 0.7;  ///< of a strip's roof
constexpr double kDormer_mm = 2.4, kLeastWidth_mm = 12.0;
constexpr double kLeastFront_mm = 2.0;  ///< of the upright panel below an eave
constexpr double kLeastStrut_mm = 7.5;  ///< from a tent's eave: its tab is below it
constexpr double kMostEaves_mm = 12.0;  ///< beyond the wall below a tent
constexpr double kSlack = 2e-3;         ///< of a bound: rounding to steps is finer

/// A triangle of a roof: its plane x sin + z cos = d.
struct RoofPiece {
  double slope_rad{}, d_mm{}, area_mm2{};
  double low_mm{}, high_mm{};  ///< z
};

std::vector<RoofPiece> pieces_of(const TriangleSoup& target) {
  std::vector<RoofPiece> out;
  for (std::size_t t = 0; t < target.size(); ++t) {
    const Vec3 a = target.corner(t, 0), b = target.corner(t, 1), c = target.corner(t, 2);
    const Vec3 normal = cross(Vec3(b - a), Vec3(c - a));
    const double size = norm(normal);
    if (!(size > 0.0) || std::abs(normal[1]) > kAlongSpine * size) continue;
    const double x = normal[0] / size, z = normal[2] / size;
    if (!(x * z > 0.0)) continue;  // it falls towards the wall
    const double slope = std::atan2(std::abs(x), std::abs(z));
    if (slope < kFlattest_rad || slope > kSteepest_rad) continue;
    const Vec3 middle = (a + b + c) / 3.0;
    out.push_back({slope, std::sin(slope) * middle[0] + std::cos(slope) * middle[2], 0.5 * size,
                   std::min({a[2], b[2], c[2]}), std::max({a[2], b[2], c[2]})});
  }
  return out;
}

double depth_on(const RoofPlane& roof, double across_mm) {
  const double s = std::sin(roof.slope_rad), c = std::cos(roof.slope_rad);
  const double d = s * roof.eave.x + c * roof.eave.z;
  return 2.0 * (d - across_mm * s) / (s + c) + across_mm;
}

int steps_of(double mm, const FacetGrid& grid) {
  return static_cast<int>(std::llround(mm / grid.step_mm));
}

bool is_within(const LabelKite& k, const KiteLimits& limits) {
  const int p = k.ex - k.qx, q = k.qz - k.ez, least = limits.least_run;
  return p >= least && q >= least && p != q && k.qx >= least && k.ez >= least &&
         k.ex <= limits.most_x && k.qz <= limits.most_z && k.ex + k.qz <= limits.most_reach;
}

/// A roof's kite of one type in steps; its roof is shortened by as much as rounding asks.
LabelKite in_steps(const RoofPlane& roof, bool overhangs, const FacetGrid& grid) {
  LabelKite out;
  const double ratio = overhangs ? std::tan(0.25 * kPi + 0.5 * roof.slope_rad)
                                 : std::tan(0.5 * roof.slope_rad);  // q / p
  for (int l = steps_of(roof.length_mm(), grid); l > 0; --l) {
    const int p = overhangs ? static_cast<int>(std::llround(l / ratio)) : l;
    const int q = overhangs ? l : static_cast<int>(std::llround(l * ratio));
    if (overhangs) {
      out.qx = steps_of(roof.top.x, grid), out.qz = steps_of(roof.top.z, grid);
      out.ex = out.qx + p, out.ez = out.qz - q;
    } else {
      out.ex = steps_of(roof.eave.x, grid), out.ez = steps_of(roof.eave.z, grid);
      out.qx = out.ex - p, out.qz = out.ez + q;
    }
    const std::int64_t room = overhangs ? out.ez : out.qx, apart = std::abs(p - q);
    if (room * apart >= std::int64_t{2} * p * q) break;
  }
  return out;
}

/// Part of a strip's roof that is seen.
double seen_share(const SeenTarget& seen, const FacetGrid& grid, const RoofPlane& roof, int strip) {
  const SheetRaster& raster = seen.raster;
  const std::size_t along = raster.rows / static_cast<std::size_t>(grid.strips);
  const double from = roof.top.x - roof.top.z, to = roof.eave.x - roof.eave.z;
  std::size_t all = 0, on = 0;
  for (std::size_t c = 0; c < raster.columns; ++c) {
    const double across = raster.across_mm(c);
    if (across < from || across > to) continue;
    const double depth = depth_on(roof, across);
    for (std::size_t r = 0; r < along; ++r) {
      const std::size_t point = (static_cast<std::size_t>(strip) * along + r) * raster.columns + c;
      ++all;
      on += std::abs(static_cast<double>(seen.depth_mm[point]) - depth) <= kSeen_mm ? 1 : 0;
    }
  }
  return all == 0 ? 0.0 : static_cast<double>(on) / static_cast<double>(all);
}

/// How far panels are from what is seen in a strip, mm^3.
///
/// @param depth_mm  of the panels, x + z, by x - z; NaN where they are not
template <typename Depth>
double distance_of(const SeenTarget& seen, const FacetGrid& grid, int strip,
                   const Depth& depth_mm) {
  const SheetRaster& raster = seen.raster;
  const std::size_t along = raster.rows / static_cast<std::size_t>(grid.strips);
  double sum = 0.0;
  for (std::size_t c = 0; c < raster.columns; ++c) {
    const double depth = depth_mm(raster.across_mm(c));
    if (std::isnan(depth)) continue;
    for (std::size_t r = 0; r < along; ++r)
      sum += std::abs(
          depth -
          static_cast<double>(
              seen.depth_mm[(static_cast<std::size_t>(strip) * along + r) * raster.columns + c]));
  }
  return sum;
}

/// The same of a kite, and of what it hangs on.
double distance_of(const SeenTarget& seen, const FacetGrid& grid, const LabelKite& kite,
                   int strip) {
  const KiteSection section = kite.section(grid.step_mm);
  return distance_of(seen, grid, strip, [&](double w) {
    if (w < -section.q.z || w > section.e.x) return std::numeric_limits<double>::quiet_NaN();
    const double depth =
        w < section.e.x - section.e.z ? 2.0 * section.q.z + w : 2.0 * section.e.x - w;
    const double of_kite = section.depth_mm(w);
    if (w > section.q.x - section.q.z && w < section.e.x - section.e.z) return of_kite;
    return of_kite > depth ? of_kite : depth;
  });
}

/// The same of a roof on walls whose eave is at `eave`, over the wall, the ground and all between.
double distance_of(const SeenTarget& seen, const FacetGrid& grid, const RoofPlane& roof,
                   const KitePoint& eave, int strip) {
  return distance_of(seen, grid, strip, [&](double w) {
    const double below = w < -eave.z           ? -w
                         : w < eave.x - eave.z ? 2.0 * eave.z + w
                         : w < eave.x          ? 2.0 * eave.x - w
                                               : w;
    const bool is_roof = w >= roof.top.x - roof.top.z && w <= eave.x - eave.z;
    return is_roof ? std::max(below, depth_on(roof, w)) : below;
  });
}

/// A roof with its eave on a fold of the grid, `by` steps nearer to the wall than the shape's.
std::optional<TentRun> tent_of(RoofPlane& roof, int by, const FacetGrid& grid,
                               const KiteLimits& limits) {
  const double tan = std::tan(roof.slope_rad);
  const int x = steps_of(roof.eave.x, grid) - by;
  const double at_x = x * grid.step_mm;
  const int z = steps_of(roof.eave.z + (roof.eave.x - at_x) * tan, grid);
  if (x <= limits.least_run || z < limits.least_run || x > limits.most_x || z > limits.most_z)
    return std::nullopt;
  roof.eave = {at_x, z * grid.step_mm};
  TentRun out;
  out.level = {false, z}, out.front = {true, x};
  out.section =
      tent_at(at_x, (roof.top.z - roof.eave.z) / std::sin(roof.slope_rad), roof.slope_rad, 0.0);
  if (out.section.roof_mm < kLeastLength_mm) return std::nullopt;
  return out;
}

/// What would make a tent firm: a steeper roof over the same ground, or more room behind it.
std::string firmer(const TentSection& loose, double most_play_mm) {
  constexpr int kSteepest_deg = 80;
  constexpr double kMostMove = 0.25;  // of the way to the eave; beyond, it helps little
  const double over_mm = loose.roof_mm * std::cos(loose.slope_rad);
  const auto is_firm = [&](double foot_mm, double slope_rad) {
    const auto tent = firmest_tent(foot_mm, over_mm / std::cos(slope_rad), slope_rad);
    return tent && tent->play_mm(hands::Play{}.line_mm) <= most_play_mm;
  };
  std::vector<std::string> ways;
  const int first_deg = static_cast<int>(degrees(loose.slope_rad)) + 1;
  for (int deg = first_deg; ways.empty() && deg <= kSteepest_deg; ++deg)
    if (is_firm(loose.foot_mm, radians(deg)))
      ways.push_back(fmt::format("make it fall at about {} degrees or more", deg));
  const auto most_mm = static_cast<int>(kMostMove * loose.foot_mm);
  const std::size_t before = ways.size();
  for (int mm = 1; ways.size() == before && mm <= most_mm; ++mm)
    if (is_firm(loose.foot_mm + mm, loose.slope_rad))
      ways.push_back(fmt::format("move the shape {} mm away from the wall", mm));
  ways.push_back(R"(set "sloped": "none")");
  return fmt::format("{}", fmt::join(ways, ", or "));
}

std::string words_of(const RoofPlane& roof) {
  return fmt::format("the roof that falls at {:.0f} degrees", degrees(roof.slope_rad));
}

std::string does_not_fit(const RoofPlane& roof) {
  return fmt::format(
      "does not fit the card: it reaches {:.1f} mm forward and {:.1f} mm up; leave wall_mm and "
      "ground_mm out, or make the shape smaller",
      roof.eave.x, roof.top.z);
}

/// Stretches of strips where a roof is seen and no kite is yet.
std::vector<std::pair<int, int>> stretches(const SeenTarget& seen, const FacetGrid& grid,
                                           const RoofPlane& roof,
                                           const std::vector<std::uint8_t>& taken) {
  std::vector<std::pair<int, int>> out;
  for (int s = 0; s < grid.strips;) {
    const int first = s;
    while (s < grid.strips && taken[static_cast<std::size_t>(s)] == 0 &&
           seen_share(seen, grid, roof, s) >= kSeenShare)
      ++s;
    if ((s - first) * grid.strip_mm >= kLeastWidth_mm) out.emplace_back(first, s);
    if (s == first) ++s;
  }
  return out;
}

}  // namespace

double RoofPlane::length_mm() const { return std::hypot(eave.x - top.x, top.z - eave.z); }

std::string RefusedRoof::reason() const {
  if (!no_tent.empty()) return no_tent;
  const double slope = roof.slope_rad, length = roof.length_mm();
  if (!is_too_long) return fmt::format("{} {}", words_of(roof), does_not_fit(roof));
  const double at_eave = longest_at_eave_mm(roof.eave.x, slope),
               at_ridge = longest_at_ridge_mm(roof.top.z, slope);
  const double far = length / std::tan(0.25 * kPi - 0.5 * slope);
  return fmt::format(
      "the roof that falls at {:.0f} degrees is {:.1f} mm long across the spine, and must be at "
      "most "
      "{:.1f} mm if its eave, {:.1f} mm from the wall, holds it, or {:.1f} mm if its ridge, {:.1f} "
      "mm "
      "above the ground, does: a longer one runs into wall or ground as the card shuts; move the "
      "shape {:.1f} mm away from the wall, make the roof flatter, or set \"sloped\": \"none\"",
      degrees(slope), length, at_eave, roof.eave.x, at_ridge, roof.top.z, far - roof.eave.x);
}

std::vector<RoofPlane> roofs_of(const TriangleSoup& target, std::size_t most) {
  const std::vector<RoofPiece> pieces = pieces_of(target);
  const auto key = [](const RoofPiece& piece) {
    return std::pair{std::llround(piece.slope_rad / kSameSlope_rad),
                     std::llround(piece.d_mm / kSamePlane_mm)};
  };
  std::map<std::pair<long long, long long>, double> area;
  for (const RoofPiece& piece : pieces) area[key(piece)] += piece.area_mm2;
  std::vector<std::pair<double, std::pair<long long, long long>>> peaks;
  for (const auto& [at, sum] : area)
    if (sum >= kLeastRoof_mm2) peaks.emplace_back(sum, at);
  std::stable_sort(peaks.begin(), peaks.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<std::uint8_t> used(pieces.size(), 0);
  std::vector<RoofPlane> out;
  for (const auto& [sum, at] : peaks) {
    if (out.size() >= most) break;
    double slope = 0.0, d = 0.0, whole = 0.0;
    for (std::size_t k = 0; k < pieces.size(); ++k)
      if (used[k] == 0 && key(pieces[k]) == at) {
        slope += pieces[k].area_mm2 * pieces[k].slope_rad, d += pieces[k].area_mm2 * pieces[k].d_mm;
        whole += pieces[k].area_mm2;
      }
    if (whole < kLeastRoof_mm2) continue;
    slope /= whole, d /= whole;
    double low = std::numeric_limits<double>::infinity(), high = 0.0;
    whole = 0.0;
    for (std::size_t k = 0; k < pieces.size(); ++k) {
      const RoofPiece& piece = pieces[k];
      if (used[k] != 0 || std::abs(piece.slope_rad - slope) > kSameSlope_rad ||
          std::abs(piece.d_mm - d) > kSamePlane_mm)
        continue;
      used[k] = 1, whole += piece.area_mm2;
      low = std::min(low, piece.low_mm), high = std::max(high, piece.high_mm);
    }
    low = std::max(low, kLeastFront_mm);
    const auto at_height = [&](double z) {
      return KitePoint{(d - z * std::cos(slope)) / std::sin(slope), z};
    };
    const RoofPlane roof{slope, at_height(high), at_height(low), whole};
    if (high > low && roof.length_mm() >= kLeastLength_mm) out.push_back(roof);
  }
  return out;
}

KitePlan plan_kites(const TriangleSoup& target, const SeenTarget& seen, const FacetGrid& grid,
                    const KiteLimits& limits) {
  KitePlan out;
  std::vector<std::uint8_t> taken(static_cast<std::size_t>(grid.strips), 0);
  const int dormer =
      std::max({1, static_cast<int>(std::llround(kDormer_mm / grid.strip_mm)),
                static_cast<int>(std::ceil(limits.dormer_mm / grid.strip_mm - 1e-9))});
  for (RoofPlane roof : roofs_of(target, kMostRoofs)) {
    const auto found = stretches(seen, grid, roof, taken);
    if (found.empty()) continue;
    out.any_roof = true;
    std::vector<LabelKite> ways;
    RefusedRoof refused{roof, true};
    for (const bool overhangs : {false, true}) {
      const double longest = overhangs ? longest_at_ridge_mm(roof.top.z, roof.slope_rad)
                                       : longest_at_eave_mm(roof.eave.x, roof.slope_rad);
      if (roof.length_mm() > (1.0 + kSlack) * longest) continue;
      const LabelKite kite = in_steps(roof, overhangs, grid);
      if (is_within(kite, limits))
        ways.push_back(kite);
      else
        refused.is_too_long = false;
    }
    if (ways.empty()) {
      out.refused.push_back(refused);
      continue;
    }
    std::vector<double> far(ways.size(), 0.0);
    for (const auto& [first, end] : found)
      for (int s = first; s < end; ++s)
        for (std::size_t k = 0; k < ways.size(); ++k) far[k] += distance_of(seen, grid, ways[k], s);
    const auto best = std::min_element(far.begin(), far.end()) - far.begin();
    for (const auto& [first, end] : found) {
      if (end - first < 2) continue;
      out.runs.push_back({out.kites.size(), first, end, std::min(dormer, (end - first) / 2)});
      std::fill(taken.begin() + first, taken.begin() + end, std::uint8_t{1});
    }
    out.kites.push_back(ways[static_cast<std::size_t>(best)]);
  }
  return out;
}

TentPlan plan_tents(const TriangleSoup& target, const SeenTarget& seen, const FacetGrid& grid,
                    const KiteLimits& limits, double most_play_mm) {
  TentPlan out;
  std::vector<std::uint8_t> taken(static_cast<std::size_t>(grid.strips), 0);
  for (const RoofPlane& roof : roofs_of(target, kMostRoofs)) {
    const auto found = stretches(seen, grid, roof, taken);
    if (found.empty()) continue;
    const auto refuse = [&](std::string why) {
      out.refused.push_back({roof, false, fmt::format("{} {}", words_of(roof), why)});
    };
    std::optional<TentRun> best;
    double least = std::numeric_limits<double>::infinity();
    for (int by = 0; by <= steps_of(kMostEaves_mm, grid); ++by) {
      RoofPlane on_walls = roof;
      const auto tent = tent_of(on_walls, by, grid, limits);
      if (!tent) continue;
      double far = 0.0;
      for (const auto& [first, end] : found)
        for (int s = first; s < end; ++s)
          far += distance_of(seen, grid, on_walls, on_walls.eave, s);
      if (far < least) least = far, best = tent;
    }
    if (!best) {
      refuse(does_not_fit(roof));
      continue;
    }
    const TentSection& asked = best->section;
    const double reach = grid.step_mm * (best->front.offset + best->level.offset) + asked.roof_mm,
                 most = grid.step_mm * limits.most_reach;
    const auto tent = firmest_tent(asked.foot_mm, asked.roof_mm, asked.slope_rad);
    if (reach > most) {
      refuse(
          fmt::format("would stick out of the shut card: it reaches {:.1f} mm from the spine, "
                      "and the card {:.1f} mm; leave wall_mm and ground_mm out",
                      reach, most));
    } else if (!tent) {
      refuse(
          fmt::format("passes through the wall as the card shuts: its ridge is {:.1f} mm from "
                      "the wall; move the shape away from it",
                      roof.top.x));
    } else if (tent->strut_at_mm < kLeastStrut_mm) {
      refuse(
          fmt::format("is too small: its strut would be {:.1f} mm from its eave, and the tab "
                      "there needs {:g} mm",
                      tent->strut_at_mm, kLeastStrut_mm));
    } else if (const double play = tent->play_mm(hands::Play{}.line_mm); play > most_play_mm) {
      refuse(
          fmt::format("would be loose: where folds are {:g} mm off their lines, its ridge moves by "
                      "{:.2f} mm on a sheet that stays, and the card holds with {:.2f} mm; {}",
                      hands::Play{}.line_mm, play, most_play_mm, firmer(*tent, most_play_mm)));
    } else {
      best->section = *tent;
      for (const auto& [first, end] : found) {
        best->first = first, best->end = end;
        out.runs.push_back(*best);
        std::fill(taken.begin() + first, taken.begin() + end, std::uint8_t{1});
      }
    }
  }
  return out;
}

std::vector<Label> tent_labels(const FacetPlanes& planes, const FacetGrid& grid,
                               const TentRun& run) {
  std::vector<Label> out(static_cast<std::size_t>(grid.columns), kGroundLabel);
  const auto at = [&](int across) { return out.begin() + grid.wall + across; };
  const int z = run.level.offset, x = run.front.offset;
  std::fill(out.begin(), at(-z), kWallLabel);
  std::fill(at(-z), at(x - z), planes.find(run.level));
  std::fill(at(x - z), at(x), planes.find(run.front));
  return out;
}

std::vector<Label> kite_labels(const FacetPlanes& planes, const FacetGrid& grid, const KiteRun& run,
                               int strip) {
  const LabelKite& kite = planes.kites()[run.kite];
  const int k = static_cast<int>(run.kite);
  const Label level = planes.find({false, kite.qz}), upright = planes.find({true, kite.ex});
  std::vector<Label> out(static_cast<std::size_t>(grid.columns), kGroundLabel);
  int from = 0;
  const auto until = [&](int across, Label label) {
    std::fill(out.begin() + from, out.begin() + grid.wall + across, label);
    from = grid.wall + across;
  };
  until(-kite.qz, kWallLabel);
  if (run.is_dormer(strip)) {
    until(kite.ex - kite.qz, level);
  } else {
    until(kite.qx - kite.qz, level);
    until(kite.qx - kite.ez, planes.find({true, kite.qx, k}));
    until(kite.ex - kite.ez, planes.find({false, kite.ez, k}));
  }
  until(kite.ex, upright);
  return out;
}

}  // namespace popcut
