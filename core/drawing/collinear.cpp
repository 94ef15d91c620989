// SPDX-License-Identifier: MIT
#include "core/drawing/collinear.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "core/drawing/linework.hpp"

namespace popcut {
namespace {

bool is_long(const Segment& s) { return distance(s.a, s.b) >= kLongSegment; }

}  // namespace

CollinearIndex::Sizes CollinearIndex::sizes_of(std::span<const Segment> all) {
  Sizes sizes;
  Box box;
  double short_mm = 0.0, long_mm = 0.0;
  for (const Segment& s : all) {
    box.add(s.a);
    box.add(s.b);
    const double l = distance(s.a, s.b);
    (l >= kLongSegment ? long_mm : short_mm) += l;
    ++(l >= kLongSegment ? sizes.longs : sizes.shorts);
  }
  if (all.empty()) return sizes;
  sizes.middle = {(box.x0 + box.x1) / 2, (box.y0 + box.y1) / 2};
  sizes.reach = std::hypot(box.width(), box.height()) / 2 + 1.0;
  const auto n = static_cast<double>(all.size());
  const double mean =
      sizes.shorts > 0 ? short_mm / static_cast<double>(sizes.shorts) : kLongSegment;
  // Queries of long segments also visit the cells of short ones: eight cells each on average.
  sizes.short_cell = std::max({2.0 * mean, (short_mm + long_mm) / (8.0 * n), 0.1});
  if (sizes.longs > 0) sizes.usual_long = long_mm / static_cast<double>(sizes.longs);
  sizes.long_cell = std::max(long_mm / (8.0 * n), kLongSegment);
  return sizes;
}

CollinearIndex::CollinearIndex(std::span<const Segment> all, double tolerance)
    : sizes_(sizes_of(all)),
      tolerance_(tolerance),
      bins_(sizes_.middle, sizes_.reach, sizes_.usual_long, tolerance),
      shorts_(sizes_.short_cell, tolerance, sizes_.shorts + sizes_.longs / 8),
      longs_by_place_(sizes_.long_cell, tolerance, sizes_.shorts > 0 ? sizes_.longs : 0),
      any_short_(sizes_.shorts > 0),
      head_(std::bit_ceil(2 * sizes_.longs + 16), -1) {
  lines_.reserve(sizes_.longs);
  segments_.reserve(sizes_.longs);
  ids_.reserve(sizes_.longs);
}

void CollinearIndex::insert(const Segment& segment, std::uint32_t id) {
  if (!is_long(segment)) return shorts_.insert(segment, id);
  if (any_short_) longs_by_place_.insert(segment, id);
  const LongLine line = bins_.line_of(segment);
  const auto index = static_cast<std::uint32_t>(segments_.size());
  bins_.each_bin(line, [&](std::uint64_t bin) {
    std::int32_t& head = head_[slot(bin)];
    lines_.push_back({line, bin, index, head});
    head = static_cast<std::int32_t>(lines_.size() - 1);
  });
  segments_.push_back(segment);
  ids_.push_back(id);
}

void CollinearIndex::covered_by_long(const Segment& segment, std::uint32_t not_this,
                                     std::vector<Covered>& out) {
  const double l = distance(segment.a, segment.b);
  bins_.each_near(bins_.line_of(segment), [&](std::uint64_t bin, const LongLine& seen) {
    for (std::int32_t i = head_[slot(bin)]; i >= 0; i = lines_[static_cast<std::size_t>(i)].next) {
      const Entry& other = lines_[static_cast<std::size_t>(i)];
      const std::size_t index = other.segment;
      if (other.bin != bin || !bins_.may_share(seen, other.line) || ids_[index] == not_this)
        continue;
      Covered part{0.0, 0.0, ids_[index]};
      if (overlap(segment, l, segments_[index], tolerance_, part.from, part.to))
        out.push_back(part);
    }
  });
}

void CollinearIndex::covered(const Segment& segment, std::uint32_t not_this,
                             std::vector<Covered>& out) {
  out.clear();
  shorts_.find(segment, not_this, out);  // also finds parts of long queries
  if (is_long(segment))
    covered_by_long(segment, not_this, out);
  else
    longs_by_place_.find(segment, not_this, out);
  std::sort(out.begin(), out.end(), [](const Covered& a, const Covered& b) {
    if (a.from != b.from) return a.from < b.from;
    return a.by != b.by ? a.by < b.by : a.to < b.to;
  });
  const auto same = [](const Covered& a, const Covered& b) {
    return a.from == b.from && a.to == b.to && a.by == b.by;
  };
  out.erase(std::unique(out.begin(), out.end(), same), out.end());
}

}  // namespace popcut
