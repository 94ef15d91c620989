// SPDX-License-Identifier: MIT
#include "core/design/outline/bridges.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>

namespace popcut {
namespace {

/// Where a ring crosses the height `y`, from left to right.
std::vector<double> crossings(const Ring& ring, double y) {
  std::vector<double> out;
  for (std::size_t k = 0; k < ring.size(); ++k) {
    const Vec2 &a = ring[k], &b = ring[(k + 1) % ring.size()];
    if ((a[1] <= y) == (b[1] <= y)) continue;
    out.push_back(a[0] + (b[0] - a[0]) * (y - a[1]) / (b[1] - a[1]));
  }
  std::sort(out.begin(), out.end());
  return out;
}

bool holds(const Ring& ring, const Vec2& p) {
  const std::vector<double> at = crossings(ring, p[1]);
  return std::count_if(at.begin(), at.end(), [&](double x) { return x < p[0]; }) % 2 == 1;
}

constexpr int kTried = 24;  // heights at which a bridge is tried
constexpr int kSides = 4;   // stretches of its ends
constexpr double kMostWork = 2e9;

/// A hole, and a piece that stands free in it.
struct Island {
  const Ring* hole{};
  const Ring* outline{};
  Eigen::AlignedBox2d box;
};

std::vector<Island> islands_in(const std::vector<Area>& areas) {
  std::vector<Island> out(areas.size());
  for (std::size_t k = 0; k < areas.size(); ++k) {
    out[k].outline = &areas[k].outline;
    for (const Vec2& p : areas[k].outline) out[k].box.extend(p);
  }
  std::vector<double> least(areas.size(), std::numeric_limits<double>::infinity());
  for (const Area& around : areas)
    for (const Ring& hole : around.holes) {
      Eigen::AlignedBox2d box;
      for (const Vec2& p : hole) box.extend(p);
      // Of holes within each other the smallest one is around the piece.
      for (std::size_t k = 0; k < areas.size(); ++k)
        if (&areas[k] != &around && box.volume() < least[k] && box.contains(out[k].box) &&
            holds(hole, areas[k].outline.front()))
          out[k].hole = &hole, least[k] = box.volume();
    }
  std::erase_if(out, [](const Island& island) { return island.hole == nullptr; });
  return out;
}

/// A stretch of a line from an island to the border of its hole.
struct Span {
  double from{}, to{};
  [[nodiscard]] double length() const { return std::abs(to - from); }
};

/// At the height `y`, to the left or the right of the island.
std::optional<Span> span_at(const Island& island, double y, bool right) {
  const std::vector<double> own = crossings(*island.outline, y), rim = crossings(*island.hole, y);
  if (own.empty()) return std::nullopt;
  const double from = right ? own.back() : own.front();
  std::optional<double> to;
  for (const double x : rim) {
    if (right && x >= from && (!to || x < *to)) to = x;
    if (!right && x <= from && (!to || x > *to)) to = x;
  }
  if (!to) return std::nullopt;
  return Span{from, *to};
}

/// The shortest bridge on one side, as a closed line that goes a little into both.
std::optional<Ring> bridge(const Island& island, double width, bool right) {
  const double low = island.box.min()[1], high = island.box.max()[1];
  const double wide = std::min(width, 0.9 * (high - low));
  std::optional<Ring> best;
  double least = std::numeric_limits<double>::infinity();
  for (int k = 0; k <= kTried; ++k) {
    const double bottom = low + 0.02 * (high - low) + (0.96 * (high - low) - wide) * k / kTried;
    std::vector<Span> spans;
    double longest = 0.0;
    for (int side = 0; side <= kSides; ++side) {
      const auto span = span_at(island, bottom + wide * side / kSides, right);
      if (!span) break;
      spans.push_back(*span);
      longest = std::max(longest, span->length());
    }
    // In the middle if it makes no difference.
    const double off = std::abs(bottom + 0.5 * wide - 0.5 * (low + high));
    if (spans.size() != kSides + 1 || longest + 0.25 * off >= least) continue;
    least = longest + 0.25 * off;
    const double into = (right ? 1.0 : -1.0) * 0.1 * wide;
    Ring ring;
    for (int side = 0; side <= kSides; ++side)
      ring.emplace_back(spans[static_cast<std::size_t>(side)].to + into,
                        bottom + wide * side / kSides);
    for (int side = kSides; side >= 0; --side)
      ring.emplace_back(spans[static_cast<std::size_t>(side)].from - into,
                        bottom + wide * side / kSides);
    if (!right) std::reverse(ring.begin(), ring.end());
    best = std::move(ring);
  }
  return best;
}

}  // namespace

Result<BridgedAreas> with_bridges(std::vector<Area> areas, double width_mm) {
  if (!(width_mm > 0.0) || areas.size() < 2) return BridgedAreas{std::move(areas), 0};
  std::vector<Ring> bridges;
  std::size_t joined = 0;
  const std::vector<Island> islands = islands_in(areas);
  double work = 0.0;
  for (const Island& island : islands)
    work +=
        2.0 * kTried * kSides * static_cast<double>(island.hole->size() + island.outline->size());
  if (work > kMostWork)
    return tl::unexpected(too_much(fmt::format(
        "it has {} parts that stand free in holes with very many points; give at most 100 such "
        "parts, or set \"bridge\" to 0 and draw bridges of your own",
        islands.size())));
  for (const Island& island : islands) {
    const std::size_t before = bridges.size();
    for (const bool right : {false, true})
      if (auto ring = bridge(island, width_mm, right)) bridges.push_back(std::move(*ring));
    joined += bridges.size() > before ? 1 : 0;
  }
  if (joined == 0) return BridgedAreas{std::move(areas), 0};
  std::vector<Ring> rings;
  for (Area& area : areas) {
    rings.push_back(std::move(area.outline));
    for (Ring& hole : area.holes) rings.push_back(std::move(hole));
  }
  for (Ring& ring : bridges) rings.push_back(std::move(ring));
  auto whole = areas_within(rings, FillRule::NonZero);
  if (!whole) return tl::unexpected(whole.error());
  return BridgedAreas{std::move(*whole), joined};
}

}  // namespace popcut
