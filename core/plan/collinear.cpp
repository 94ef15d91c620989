// SPDX-License-Identifier: MIT
#include "core/plan/collinear.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "core/plan/linework.hpp"

namespace popcut {
namespace {

constexpr double kLong = 5.0;       // mm
constexpr double kAngleBin = 0.01;  // rad; segments that share 2 mm within 0.01 mm differ by less
constexpr std::int64_t kAngles = 315;  // bins over half a turn, the last one is shorter

bool is_long(const Segment& s) { return distance(s.a, s.b) >= kLong; }

}  // namespace

CollinearIndex::Sizes CollinearIndex::sizes_of(std::span<const Segment> all) {
  Sizes sizes;
  Box box;
  double short_mm = 0.0, long_mm = 0.0;
  for (const Segment& s : all) {
    box.add(s.a);
    box.add(s.b);
    const double l = distance(s.a, s.b);
    (l >= kLong ? long_mm : short_mm) += l;
    ++(l >= kLong ? sizes.longs : sizes.shorts);
  }
  if (all.empty()) return sizes;
  sizes.middle = {(box.x0 + box.x1) / 2, (box.y0 + box.y1) / 2};
  sizes.reach = std::hypot(box.width(), box.height()) / 2 + 1.0;
  const double n = static_cast<double>(all.size());
  const double mean = sizes.shorts > 0 ? short_mm / static_cast<double>(sizes.shorts) : kLong;
  // Long segments look through the cells of the short ones too: eight cells each on average.
  sizes.short_cell = std::max({2.0 * mean, (short_mm + long_mm) / (8.0 * n), 0.1});
  sizes.long_cell = std::max(long_mm / (8.0 * n), kLong);
  return sizes;
}

CollinearIndex::CollinearIndex(std::span<const Segment> all, double tolerance)
    : sizes_(sizes_of(all)),
      tolerance_(tolerance),
      offset_bin_(tolerance + kAngleBin * sizes_.reach),
      shorts_(sizes_.short_cell, tolerance, sizes_.shorts + sizes_.longs / 8),
      longs_by_place_(sizes_.long_cell, tolerance, sizes_.shorts > 0 ? sizes_.longs : 0),
      any_short_(sizes_.shorts > 0),
      head_(std::bit_ceil(2 * sizes_.longs + 16), -1) {
  lines_.reserve(sizes_.longs);
  segments_.reserve(sizes_.longs);
  ids_.reserve(sizes_.longs);
}

CollinearIndex::Line CollinearIndex::line_of(const Segment& s) const {
  double angle = std::atan2(s.b.y - s.a.y, s.b.x - s.a.x);
  if (angle < 0.0) angle += std::numbers::pi;
  if (angle >= std::numbers::pi) angle -= std::numbers::pi;
  const double nx = -std::sin(angle), ny = std::cos(angle);
  const PagePoint half{(s.a.x + s.b.x) / 2 - sizes_.middle.x,
                       (s.a.y + s.b.y) / 2 - sizes_.middle.y};
  return {std::min(static_cast<std::int64_t>(angle / kAngleBin), kAngles - 1), angle,
          nx * half.x + ny * half.y};
}

std::size_t CollinearIndex::slot(std::int64_t angle, std::int64_t offset) const {
  std::uint64_t h = static_cast<std::uint64_t>(offset * kAngles + angle) * 0x9E3779B97F4A7C15ULL;
  h ^= h >> 32;
  return h & (head_.size() - 1);
}

void CollinearIndex::insert(const Segment& segment, std::uint32_t id) {
  if (!is_long(segment)) return shorts_.insert(segment, id);
  if (any_short_) longs_by_place_.insert(segment, id);
  const Line line = line_of(segment);
  const auto bin = static_cast<std::int64_t>(std::floor(line.offset / offset_bin_));
  std::int32_t& head = head_[slot(line.angle, bin)];
  lines_.push_back({static_cast<float>(line.radians), static_cast<float>(line.offset),
                    static_cast<std::int32_t>(bin * kAngles + line.angle), head});
  head = static_cast<std::int32_t>(segments_.size());
  segments_.push_back(segment);
  ids_.push_back(id);
}

// The neighbours of a bin: angles one less and one more, round the half turn, where the offset
// changes its sign.
void CollinearIndex::covered_by_long(const Segment& segment, std::uint32_t not_this,
                                     std::vector<Covered>& out) {
  const double l = distance(segment.a, segment.b);
  const Line line = line_of(segment);
  // Along the line from the foot of the middle of the drawing: where the segment begins and ends.
  const double ux = std::cos(line.radians), uy = std::sin(line.radians);
  const auto along = [&](const PagePoint& p) {
    return (p.x - sizes_.middle.x) * ux + (p.y - sizes_.middle.y) * uy;
  };
  const double from = along(segment.a), to = along(segment.b);
  const double near_mm = tolerance_ + 0.001 + 1e-6 * sizes_.reach;  // floats are rounded
  // The last bin is narrower than the others: beside it two are looked at.
  for (std::int64_t a = line.angle - 2; a <= line.angle + 2; ++a) {
    const bool near = std::abs(a - line.angle) <= 1 || a >= kAngles || a < 0;
    if (!near) continue;
    const std::int64_t angle = (a + kAngles) % kAngles;
    const double side = a == angle ? 1.0 : -1.0, offset = side * line.offset;
    const double radians =
        line.radians + (a < 0 ? std::numbers::pi : 0.0) - (a >= kAngles ? std::numbers::pi : 0.0);
    const auto bin = static_cast<std::int64_t>(std::floor(offset / offset_bin_));
    for (std::int64_t r = bin - 1; r <= bin + 1; ++r)
      for (std::int32_t s = head_[slot(angle, r)]; s >= 0;
           s = lines_[static_cast<std::size_t>(s)].next) {
        const auto index = static_cast<std::size_t>(s);
        const LongLine& other = lines_[index];
        if (other.bin != r * kAngles + angle) continue;
        // How far the segment's ends are from the other line: both on one side of it, or near?
        const double turn = static_cast<double>(other.radians) - radians;
        const double sine = side * turn * (1.0 - turn * turn / 6);
        const double foot = offset * (1.0 - turn * turn / 2) - static_cast<double>(other.offset);
        const double first = foot - from * sine, last = foot - to * sine;
        if (std::min(first, last) > near_mm || std::max(first, last) < -near_mm) continue;
        if (ids_[index] == not_this) continue;
        Covered part{0.0, 0.0, ids_[index]};
        if (overlap(segment, l, segments_[index], tolerance_, part.from, part.to))
          out.push_back(part);
      }
  }
}

void CollinearIndex::covered(const Segment& segment, std::uint32_t not_this,
                             std::vector<Covered>& out) {
  out.clear();
  shorts_.find(segment, not_this, out);  // parts of long ones too
  if (is_long(segment))
    covered_by_long(segment, not_this, out);
  else
    longs_by_place_.find(segment, not_this, out);
  std::sort(out.begin(), out.end(), [](const Covered& a, const Covered& b) {
    if (a.from != b.from) return a.from < b.from;
    return a.by != b.by ? a.by < b.by : a.to < b.to;
  });
}

}  // namespace popcut
