// SPDX-License-Identifier: MIT
#include "core/design/boxes/box_ends.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "core/geometry/angle.hpp"

namespace popcut {
namespace {

// What holds the ends of a box: found with verify's wobble on random boxes.
constexpr double kHeldBend_rad = radians(3.5);  ///< of each half, with an inner wall
constexpr double kFreeBend_rad = radians(8.0);  ///< without one
constexpr double kSlim = 2.0;                   ///< height over half width; above, ends lean more
constexpr double kSlimBend_rad = radians(0.9), kMostBend_rad = radians(14.0);
constexpr double kHipBend_rad = radians(12.0),
                 kMostHipBend_rad = radians(18.0);  ///< of a pyramid's slopes at its ends
constexpr double kPitch_rad = radians(6.5);         ///< of a flat roof
constexpr double kInner = 0.9;  ///< height of an inner wall, of that of the walls
constexpr double kFinger_mm = 20.0;
constexpr double kClear_mm = 0.5;  ///< between what passes each other
constexpr int kOpenings = 64;      ///< that are looked at, from open to shut

using EndsOut = std::array<bool, 2>;
constexpr std::array<EndsOut, 3> kWays{EndsOut{true, false}, {false, true}, {false, false}};

/// A box or a tent as the card shuts: lengths in mm; c is the cosine of half of the opening.
struct MovingBlock {
  bool is_tent{};
  double half{}, height{}, rise{};
  BoxElement box{};

  MovingBlock(const Block& block, const BoxElement& element)
      : is_tent(block.is_tent()),
        half(block.half_mm),
        height(is_tent ? 0.0 : element.height_mm),
        rise(is_tent ? block.rise_mm : element.rise_mm),
        box(element) {}

  /// The height of the tops of its walls, which the pages lift as they shut.
  [[nodiscard]] double top(double c) const { return height + half * c; }
  /// How high the ridge is above them.
  [[nodiscard]] double ridge(double c) const { return std::hypot(rise, half * c); }
  /// How far the middle of an end is from the line between its walls.
  [[nodiscard]] double end(double c) const { return std::hypot(box.bend_mm, half * c); }
  /// Of its ends, above the walls.
  [[nodiscard]] double gable() const { return is_pyramid() ? 0.0 : rise; }
  [[nodiscard]] bool is_pyramid() const { return !is_tent && box.lid == BoxLid::Pyramid; }
  /// The middle of the foot of a pyramid's slope at an end: outward from that end, and up from the
  /// tops of the walls.
  [[nodiscard]] Vec2 foot(double c) const {
    return hip_foot(box, 2.0 * std::acos(c)) - Vec2{0.5 * (box.to_mm - box.from_mm), 0.0};
  }
};

/// Whether a condition holds at each opening.
template <typename Holds>
bool holds_always(const Holds& holds) {
  for (int k = 0; k <= kOpenings; ++k)
    if (!holds(static_cast<double>(k) / kOpenings)) return false;
  return true;
}

/// The slope at an end of a pyramid, cut across the spine: two lines from its edges up to its fold.
struct SlopeSection {
  double across{};        ///< of an edge from the middle, over the sine of the half opening
  double edge{}, fold{};  ///< their heights
};
/// The slope at a place outward from its end; none beyond its foot.
std::optional<SlopeSection> slope_at(const MovingBlock& pyramid, double out_mm, double c) {
  const Vec2 foot = pyramid.foot(c);
  if (!(foot.x() > 0.0) || out_mm > foot.x()) return std::nullopt;
  const double share = out_mm / foot.x(), low = pyramid.top(c), top = pyramid.ridge(c),
               half_length = 0.5 * (pyramid.box.to_mm - pyramid.box.from_mm);
  return SlopeSection{
      pyramid.half * (1.0 - share), low + share * foot.y(),
      low + top + (foot.y() - top) * (half_length + out_mm) / (half_length + foot.x())};
}

/// Whether the slopes of two pyramids that fold toward each other do not meet.
bool slopes_pass(const MovingBlock& one, const MovingBlock& other, double gap_mm, double c) {
  constexpr int kPlaces = 8;
  const double reach = one.foot(c).x();
  for (int k = 0; k <= kPlaces; ++k) {
    const double out = reach * k / kPlaces;
    const auto a = slope_at(one, out, c), b = slope_at(other, gap_mm - out, c);
    if (!a || !b || gap_mm < out) continue;
    // Heights in the middle and at the edge of the narrower one: the same one must be above.
    const auto height = [](const SlopeSection& slope, double across) {
      return slope.across > 0.0 ? slope.fold + (slope.edge - slope.fold) * across / slope.across
                                : slope.fold;
    };
    const double across = std::min(a->across, b->across), middle = a->fold - b->fold,
                 beside = height(*a, across) - height(*b, across);
    if (std::min(std::abs(middle), std::abs(beside)) < kClear_mm ||
        (middle > 0.0) != (beside > 0.0))
      return false;
  }
  return true;
}

/// Whether the slope at an end of a pyramid, which folds outward over the block beside it, goes
/// neither through its roof nor through the slope that folds toward it from there.
///
/// @param gap_mm           between both; 0 where they touch
/// @param other_has_slope  whether the other one is a pyramid with a slope at this end
bool clears_roof(const MovingBlock& pyramid, const MovingBlock& other, double gap_mm,
                 bool other_has_slope) {
  return holds_always([&](double c) {
    const Vec2 foot = pyramid.foot(c);
    const double from_other = other_has_slope ? other.foot(c).x() : 0.0;
    if (foot.x() + from_other < gap_mm - kClear_mm) return true;
    const double low = pyramid.top(c), walls = other.top(c), ridge = other.ridge(c);
    const double corner = walls + ridge * std::max(0.0, 1.0 - pyramid.half / other.half);
    if (low + foot.y() >= walls + ridge + kClear_mm && low >= corner + kClear_mm) return true;
    if (gap_mm == 0.0 || !other.is_pyramid()) return false;
    // Between the slopes of a pyramid there is room up to its end, which folds away.
    const double into = foot.x() - gap_mm,
                 half_length = 0.5 * (other.box.to_mm - other.box.from_mm),
                 at_border =
                     pyramid.half * std::max(0.0, 1.0 - gap_mm / std::max(foot.x(), gap_mm));
    return into < std::min(other.end(c), half_length) && at_border < other.half &&
           (!other_has_slope || slopes_pass(pyramid, other, gap_mm, c));
  });
}

/// Whether an end that folds outward passes the block beside it, whose end folds away from it.
///
/// @param verge_mm  of the roof beside it, toward it
bool passes(const MovingBlock& box, const MovingBlock& other, double gap_mm, double verge_mm) {
  return holds_always([&](double c) {
    const double out = box.end(c);
    if (!other.is_tent) {
      // Both ends are folded alike: their middles, and the end beside the other one's walls.
      const double at_walls = out * std::max(0.0, 1.0 - other.half / box.half);
      if (out > gap_mm + other.end(c) - kClear_mm || at_walls > gap_mm - kClear_mm) return false;
    }
    const bool is_lower = box.top(c) + box.gable() + kClear_mm < other.top(c);
    if (other.is_pyramid())
      return is_lower || out + std::max(0.0, other.foot(c).x()) < gap_mm - kClear_mm;
    const double under = gap_mm - verge_mm - kClear_mm;
    if (is_lower || out <= under) return true;
    // The end is below the roof from the middle up to this place, of half of its width.
    const double most = 1.0 - std::max(0.0, under) / out;
    for (const double at : {0.0, most})
      if (box.top(c) + box.gable() * (1.0 - at) + kClear_mm >=
          other.top(c) + other.ridge(c) * (1.0 - at * box.half / other.half))
        return false;
    return true;
  });
}

/// Chooses how the ends of a row fold: the cheapest way from box to box.
class EndsChooser {
 public:
  explicit EndsChooser(const BlockRow& row) : row_(row) {
    for (std::size_t k = 0; k < row.blocks.size(); ++k)
      for (std::size_t way = 0; way < kWays.size(); ++way) boxes_.push_back(made(k, kWays[way]));
  }

  /// The ways, one a block; none where there is no room.
  [[nodiscard]] std::optional<std::vector<std::size_t>> cheapest() {
    constexpr double kNever = std::numeric_limits<double>::infinity();
    const std::size_t count = row_.blocks.size();
    std::vector<std::array<double, kWays.size()>> cost(count);
    std::vector<std::array<std::size_t, kWays.size()>> before(count);
    for (std::size_t k = 0; k < count; ++k)
      for (std::size_t way = 0; way < kWays.size(); ++way) {
        cost[k][way] = kNever;
        if (!can_be(k, way)) continue;
        for (std::size_t from = 0; from < (k == 0 ? 1 : kWays.size()); ++from) {
          const double so_far = k == 0 ? 0.0 : cost[k - 1][from];
          if (so_far == kNever || (k > 0 && !fit(k - 1, from, way))) continue;
          if (so_far + cost_of(way) < cost[k][way])
            cost[k][way] = so_far + cost_of(way), before[k][way] = from;
        }
        if (cost[k][way] < kNever) reached_ = k + 1;
      }
    const auto least = std::min_element(cost.back().begin(), cost.back().end());
    if (*least == kNever) return std::nullopt;
    std::vector<std::size_t> out(count);
    out.back() = static_cast<std::size_t>(least - cost.back().begin());
    for (std::size_t k = count - 1; k > 0; --k) out[k - 1] = before[k][out[k]];
    return out;
  }
  /// The first block that has no room beside the one before it, after `cheapest` found no way.
  [[nodiscard]] std::size_t without_room() const { return reached_; }
  [[nodiscard]] const BoxElement& box(std::size_t k, std::size_t way) const {
    return boxes_[k * kWays.size() + way];
  }
  [[nodiscard]] MovingBlock moving(std::size_t k, std::size_t way) const {
    return MovingBlock(row_.blocks[k], box(k, way));
  }
  [[nodiscard]] double gap_mm(std::size_t k) const {
    return row_.blocks[k + 1].from_mm - row_.blocks[k].to_mm;
  }

 private:
  [[nodiscard]] bool touches_before(std::size_t k) const { return k > 0 && row_.touches[k - 1]; }

  [[nodiscard]] BoxElement made(std::size_t k, EndsOut ends_out) const {
    BoxElement out = box_of(row_.blocks[k]);
    if (!row_.blocks[k].is_tent()) make_firm(out, ends_out, !touches_before(k) && !row_.touches[k]);
    return out;
  }
  /// The way of most cards first; a box without an inner wall last.
  static double cost_of(std::size_t way) {
    constexpr std::array<double, kWays.size()> kCost{0.0, 0.01, 1.0};
    return kCost[way];
  }
  [[nodiscard]] bool can_be(std::size_t k, std::size_t way) const {
    if (row_.blocks[k].is_tent()) return way == 0;
    const auto [before, after] = kWays[way];
    if ((before && touches_before(k)) || (after && row_.touches[k])) return false;
    // Between two that touch it there is no other way.
    return before || after || (touches_before(k) && row_.touches[k]) ||
           can_move(box(k, way)).has_value();
  }
  /// Whether block `k` and the next one open and shut beside each other.
  [[nodiscard]] bool fit(std::size_t k, std::size_t way, std::size_t next) const {
    if (row_.touches[k]) return true;
    const MovingBlock a = moving(k, way), b = moving(k + 1, next);
    const double gap =
        gap_mm(k) - std::max({0.0, a.is_tent ? 0.0 : a.box.to_mm - row_.blocks[k].to_mm,
                              b.is_tent ? 0.0 : row_.blocks[k + 1].from_mm - b.box.from_mm});
    const bool a_out = !a.is_tent && kWays[way][1], b_out = !b.is_tent && kWays[next][0];
    if (a_out && b_out) return a.end(1.0) + b.end(1.0) < gap - kClear_mm;
    return (!a_out || passes(a, b, gap, b.box.verge_mm[0])) &&
           (!b_out || passes(b, a, gap, a.box.verge_mm[1]));
  }

  const BlockRow& row_;
  std::vector<BoxElement> boxes_;  ///< `kWays.size()` a block
  std::size_t reached_{};
};

}  // namespace

BoxElement box_of(const Block& block) {
  BoxElement out;
  out.from_mm = block.from_mm, out.to_mm = block.to_mm;
  out.half_mm = block.half_mm, out.height_mm = block.height_mm;
  out.rise_mm = block.rise_mm;
  out.eaves_mm = block.eaves_mm, out.verge_mm = block.verge_mm;
  out.lid = block.roof == BlockRoof::Pyramid ? BoxLid::Pyramid : BoxLid::Gabled;
  if (block.roof == BlockRoof::Flat) {
    // Half of the pitch above the shape's roof, and half below.
    out.rise_mm = block.half_mm * std::tan(kPitch_rad);
    out.height_mm -= 0.5 * out.rise_mm;
    out.eaves_mm = 0.0, out.verge_mm = {0.0, 0.0};
  }
  return out;
}

TentElement tent_of(const Block& block) {
  TentElement out;
  out.from_mm = block.from_mm, out.to_mm = block.to_mm;
  out.left_foot_mm = out.right_foot_mm = block.half_mm;
  out.left_panel_mm = out.right_panel_mm = std::hypot(block.half_mm, block.rise_mm);
  return out;
}

void make_firm(BoxElement& box, EndsOut ends_out, bool is_free) {
  box.ends_out = ends_out;
  const bool is_held = ends_out[0] != ends_out[1] && box.half_mm > kBoxTab_mm + 1.0;
  const double slim = std::max(0.0, box.height_mm / box.half_mm - kSlim);
  const double bend_rad = (is_held ? kHeldBend_rad : kFreeBend_rad) + slim * kSlimBend_rad;
  box.bend_mm = box.half_mm * std::tan(std::min(bend_rad, kMostBend_rad));
  if (box.lid == BoxLid::Pyramid)
    box.hip_bend_mm =
        box.half_mm * std::tan(std::min(kHipBend_rad + slim * kSlimBend_rad, kMostHipBend_rad));
  if (is_held) box.inner_mm = kInner * box.height_mm;
  // Below a spire it leaves room for a finger that presses the spire's tabs.
  if (is_held && box.lid == BoxLid::Pyramid && box.half_mm < kFinger_mm)
    box.inner_mm = std::clamp(box.height_mm - kBoxTab_mm - box.half_mm - 2.0, 0.5 * box.inner_mm,
                              box.inner_mm);
  if (!is_free || ends_out[0] == ends_out[1]) return;
  // Half of the bend in front of the shape's ends, and half behind.
  const double by = (ends_out[0] ? 0.5 : -0.5) * box.bend_mm;
  box.from_mm += by, box.to_mm += by;
  box.verge_mm = {std::max(0.0, box.verge_mm[0] + by), std::max(0.0, box.verge_mm[1] - by)};
}

bool can_stand(Block block, bool touches_before, bool touches_after, double thickness_mm) {
  if (block.is_tent()) return can_move(tent_of(block)).has_value();
  if (touches_before) block.from_mm += 0.5 * thickness_mm;
  if (touches_after) block.to_mm -= 0.5 * thickness_mm;
  block.eaves_mm = 0.0;  // too long ones are shortened
  BoxElement box = box_of(block);
  make_firm(box, {!touches_before, touches_before && !touches_after},
            !touches_before && !touches_after);
  return can_move(box).has_value();
}

Result<std::vector<BoxElement>> firm_boxes(const BlockRow& row) {
  EndsChooser chooser(row);
  const auto ways = chooser.cheapest();
  if (!ways) {
    const std::size_t k = chooser.without_room();
    const MovingBlock a = chooser.moving(k - 1, 0), b = chooser.moving(k, 0);
    const double needed =
        std::ceil(2.0 * std::max(a.half, b.half) + a.box.bend_mm + b.box.bend_mm + 2.0);
    return fail(ErrorKind::Infeasible, "/boxes",
                fmt::format("blocks {} and {} are {:.3g} mm apart, and an end of one of them would "
                            "pass through the other as the card shuts: leave {:g} mm between them, "
                            "or let them touch",
                            k, k + 1, chooser.gap_mm(k - 1), needed));
  }
  std::vector<BoxElement> out;
  for (std::size_t k = 0; k < row.blocks.size(); ++k) out.push_back(chooser.box(k, (*ways)[k]));
  for (std::size_t k = 0; k + 1 < row.blocks.size(); ++k) {
    const MovingBlock a(row.blocks[k], out[k]), b(row.blocks[k + 1], out[k + 1]);
    const double gap =
        row.touches[k] ? 0.0 : std::min(chooser.gap_mm(k), b.box.from_mm - a.box.to_mm);
    if (a.is_pyramid())
      out[k].has_hips[1] = clears_roof(a, b, gap, !row.touches[k] && b.is_pyramid());
    if (b.is_pyramid())
      out[k + 1].has_hips[0] =
          clears_roof(b, a, gap, !row.touches[k] && a.is_pyramid() && out[k].has_hips[1]);
  }
  return out;
}

}  // namespace popcut
