// SPDX-License-Identifier: MIT
#include "core/design/strips/strip_bridge.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace popcut {
namespace {

constexpr std::uint8_t kLeft = 1, kRight = 2, kBoth = 3;  ///< sides that a staircase has joined
constexpr int kNearPlanes = 2;      ///< heights looked at above and below the target at an offset
constexpr double kLongestStep = 6;  ///< of the coarser side's mean steps
constexpr double kEvenness = 0.1;   ///< weight of uneven steps against distances from the target

/// A panel of a neighbour that the bridge may lie in: its plane's z (level panels) or x (upright
/// ones), and its reach along the other coordinate.
struct Plane {
  double at{};
  double low{}, high{};
  PlaneId id{};
  std::uint8_t side{};
};

/// A point of a staircase where an offset ends and a height begins; the first has no offset (the
/// wall), the last no height (the ground).
struct Corner {
  double x{}, z{};
  std::int32_t offset{-1}, height{-1};  ///< indices of planes
  double off_mm{};                      ///< distance from the target
};

/// The cheapest way to a corner, for each set of sides that it has joined.
struct Way {
  std::array<double, kBoth + 1> cost;
  std::array<std::int32_t, kBoth + 1> from;
  std::array<std::uint8_t, kBoth + 1> from_sides;
};

class Bridge {
 public:
  Bridge(const Strips& strips, const BridgeAim& aim, double min_panel_mm)
      : curve_(*aim.target), least_(min_panel_mm) {
    const std::size_t first = strips.first_point(aim.left_strip);
    const std::size_t last = strips.first_panel[aim.left_strip + 1] + aim.left_strip;
    wall_mm_ = strips.z[first];
    ground_mm_ = strips.x[last];
    const int left = collect(strips, aim.left_strip, kLeft);
    const int right = collect(strips, aim.left_strip + 1, kRight);
    coarse_ = std::max(1, std::min(left, right));
    mean_step_ = 2.0 * (curve_.d() + curve_.h()) / std::max(2, left + right);
  }

  /// The corners of the best staircase, empty where none is valid.
  std::vector<Corner> solve() {
    place_corners();
    const double all = curve_.d() + curve_.h();
    find_ways(kLongestStep * all / coarse_);
    if (!is_solved()) find_ways(2.0 * (wall_mm_ + ground_mm_));
    double best = std::numeric_limits<double>::infinity();
    std::int32_t end = -1;
    for (std::size_t c = 0; c < corners_.size(); ++c)
      if (corners_[c].height < 0 && ways_[c].cost[kBoth] < best)
        best = ways_[c].cost[kBoth], end = static_cast<std::int32_t>(c);
    std::vector<Corner> out;
    std::uint8_t sides = kBoth;
    while (end >= 0) {
      const auto c = static_cast<std::size_t>(end);
      out.push_back(corners_[c]);
      end = ways_[c].from[sides];
      sides = ways_[c].from_sides[sides];
    }
    std::reverse(out.begin(), out.end());
    return out;
  }

  [[nodiscard]] const Plane& height(const Corner& c) const {
    return heights_[static_cast<std::size_t>(c.height)];
  }
  [[nodiscard]] const Plane& offset(const Corner& c) const {
    return offsets_[static_cast<std::size_t>(c.offset)];
  }
  [[nodiscard]] double wall_mm() const { return wall_mm_; }
  [[nodiscard]] double ground_mm() const { return ground_mm_; }

 private:
  /// Takes the panels of a strip beside wall and ground; returns how many there are.
  int collect(const Strips& strips, std::size_t s, std::uint8_t side) {
    int count = 0;
    for (std::uint32_t p = strips.first_panel[s]; p < strips.first_panel[s + 1]; ++p) {
      const PlaneId id = strips.plane[p];
      if (id == kWallPlane || id == kGroundPlane) continue;
      const std::size_t q = p + s;
      if (strips.x[q] == strips.x[q + 1])
        offsets_.push_back({strips.x[q], strips.z[q + 1], strips.z[q], id, side});
      else
        heights_.push_back({strips.z[q], strips.x[q], strips.x[q + 1], id, side});
      ++count;
    }
    return count;
  }

  /// The target's height over the offset x.
  [[nodiscard]] double target_height(double x) const {
    double low = -1.0, high = 1.0;  // along the chord x rises
    for (int k = 0; k < 50; ++k) {
      const double middle = 0.5 * (low + high);
      (curve_.at(middle).x < x ? low : high) = middle;
    }
    return curve_.at(high).z;
  }

  /// Corners near the target, sorted along the staircase, by x - z.
  void place_corners() {
    const auto by_place = [](const Plane& a, const Plane& b) { return a.at < b.at; };
    std::sort(heights_.begin(), heights_.end(), by_place);
    std::sort(offsets_.begin(), offsets_.end(), by_place);
    for (std::size_t i = 0; i < heights_.size(); ++i)
      if (wall_mm_ - heights_[i].at >= least_)
        corners_.push_back({0.0, heights_[i].at, -1, static_cast<std::int32_t>(i),
                            std::abs(heights_[i].at - curve_.h())});
    for (std::size_t k = 0; k < offsets_.size(); ++k) {
      const double x = offsets_[k].at;
      if (ground_mm_ - x >= least_)
        corners_.push_back({x, 0.0, static_cast<std::int32_t>(k), -1, std::abs(x - curve_.d())});
      if (x >= curve_.d()) continue;
      const auto middle = std::lower_bound(heights_.begin(), heights_.end(), target_height(x),
                                           [](const Plane& a, double z) { return a.at < z; });
      const auto begin = middle - std::min<std::ptrdiff_t>(kNearPlanes, middle - heights_.begin());
      const auto end = middle + std::min<std::ptrdiff_t>(kNearPlanes, heights_.end() - middle);
      for (auto it = begin; it != end; ++it)
        corners_.push_back({x, it->at, static_cast<std::int32_t>(k),
                            static_cast<std::int32_t>(it - heights_.begin()),
                            curve_.nearest_distance({x, it->at})});
    }
    const double most_off = 0.5 * (curve_.d() + curve_.h()) / coarse_;
    std::erase_if(corners_, [&](const Corner& c) { return !(c.off_mm <= most_off); });
    std::sort(corners_.begin(), corners_.end(),
              [](const Corner& a, const Corner& b) { return a.x - a.z < b.x - b.z; });
  }

  /// The sides that the two panels from corner a to corner b join, 0 where they are not valid.
  [[nodiscard]] std::uint8_t joins(const Corner& a, const Corner& b) const {
    if (a.height < 0 || b.offset < 0 || b.x - a.x < least_ || a.z - b.z < least_) return 0;
    const Plane &level = height(a), &upright = offset(b);
    if (std::min(b.x, level.high) - std::max(a.x, level.low) < least_) return 0;
    if (std::min(a.z, upright.high) - std::max(b.z, upright.low) < least_) return 0;
    return level.side | upright.side;
  }

  [[nodiscard]] bool is_solved() const {
    for (std::size_t c = 0; c < corners_.size(); ++c)
      if (corners_[c].height < 0 && std::isfinite(ways_[c].cost[kBoth])) return true;
    return false;
  }

  /// The cheapest ways with steps (level and upright together) of at most `reach`.
  void find_ways(double reach) {
    constexpr double kNever = std::numeric_limits<double>::infinity();
    ways_.assign(corners_.size(), {{kNever, kNever, kNever, kNever}, {-1, -1, -1, -1}, {}});
    std::size_t first = 0;
    for (std::size_t b = 0; b < corners_.size(); ++b) {
      const Corner& to = corners_[b];
      const double own = to.off_mm * to.off_mm;
      if (to.offset < 0) ways_[b].cost[0] = own;
      while (to.x - to.z - (corners_[first].x - corners_[first].z) > reach) ++first;
      for (std::size_t a = first; a < b; ++a) {
        const std::uint8_t sides = joins(corners_[a], to);
        if (sides == 0) continue;
        const double uneven = (to.x - to.z) - (corners_[a].x - corners_[a].z) - mean_step_;
        const double step = own + kEvenness * uneven * uneven;
        for (std::uint8_t had = 0; had <= kBoth; ++had) {
          const std::uint8_t now = had | sides;
          if (ways_[a].cost[had] + step >= ways_[b].cost[now]) continue;
          ways_[b].cost[now] = ways_[a].cost[had] + step;
          ways_[b].from[now] = static_cast<std::int32_t>(a);
          ways_[b].from_sides[now] = had;
        }
      }
    }
  }

  const SliceCurve& curve_;
  double least_;
  double wall_mm_{}, ground_mm_{}, mean_step_{};
  int coarse_{};
  std::vector<Plane> heights_, offsets_;
  std::vector<Corner> corners_;
  std::vector<Way> ways_;
};

void write_bridge(const Bridge& bridge, const std::vector<Corner>& corners, StripWriter& writer) {
  writer.start(0.0, bridge.wall_mm());
  writer.panel_to(0.0, corners.front().z, kWallPlane);
  for (std::size_t k = 1; k < corners.size(); ++k) {
    writer.panel_to(corners[k].x, corners[k - 1].z, bridge.height(corners[k - 1]).id);
    writer.panel_to(corners[k].x, corners[k].z, bridge.offset(corners[k]).id);
  }
  writer.panel_to(bridge.ground_mm(), 0.0, kGroundPlane);
}

/// What a strip leaves to a connector beside it.
double share_of(const Strips& strips, std::size_t s) {
  return strips.kind[s] == StripKind::Slice ? 0.5 * (strips.v_begin[s + 1] - strips.v_begin[s])
                                            : 0.0;
}

BridgeReport report_of(const Bridge& bridge, const std::vector<Corner>& corners, int slice) {
  BridgeReport out{slice, 0.0, 0, 0};
  for (const Corner& c : corners) {
    out.off_mm = std::max(out.off_mm, c.off_mm);
    if (c.height >= 0) ++(bridge.height(c).side == kLeft ? out.left_planes : out.right_planes);
    if (c.offset >= 0) ++(bridge.offset(c).side == kLeft ? out.left_planes : out.right_planes);
  }
  return out;
}

}  // namespace

BridgedStrips add_bridges(const Strips& strips, std::span<const BridgeAim> aims,
                          double min_panel_mm) {
  BridgedStrips out;
  if (aims.empty()) return {strips, {}, {}};
  StripWriter writer;
  std::size_t k = 0;
  for (std::size_t s = 0; s < strips.size(); ++s) {
    writer.copy(strips, s);
    if (k == aims.size() || aims[k].left_strip != s) continue;
    const double width = share_of(strips, s) + share_of(strips, s + 1);
    Bridge bridge(strips, aims[k], min_panel_mm);
    const std::vector<Corner> corners = width > 0.0 ? bridge.solve() : std::vector<Corner>{};
    if (corners.empty()) {
      out.refused.push_back(k);
    } else {
      write_bridge(bridge, corners, writer);
      writer.close(StripKind::Bridge, strips.slice[s], width);
      out.made.push_back(report_of(bridge, corners, strips.slice[s]));
    }
    ++k;
  }
  out.strips = writer.take();
  unify_planes(out.strips);
  return out;
}

}  // namespace popcut
