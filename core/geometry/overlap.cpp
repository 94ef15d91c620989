// SPDX-License-Identifier: MIT
#include "core/geometry/overlap.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "core/geometry/cell_choice.hpp"
#include "core/geometry/page_point.hpp"

namespace popcut {
namespace {

constexpr int kDirections = 15;      // bins of 12 degrees over a half turn
constexpr double kParallel = 0.001;  // slope up to which lines may share a part,
constexpr double kAside = 0.004;     // and mm by which snapping may have moved an end aside

int direction_of(const Segment& s) {
  double angle = std::atan2(s.b.y - s.a.y, s.b.x - s.a.x);
  if (angle < 0.0) angle += std::numbers::pi;
  return static_cast<int>(angle * kDirections / std::numbers::pi) % kDirections;
}

}  // namespace

bool overlap(const Segment& s, double l, const Segment& other, double tolerance, double& from,
             double& to) {
  const double dx = (s.b.x - s.a.x) / l;
  const double dy = (s.b.y - s.a.y) / l;
  const auto along = [&](const PagePoint& p) { return (p.x - s.a.x) * dx + (p.y - s.a.y) * dy; };
  const auto aside = [&](const PagePoint& p) { return (p.y - s.a.y) * dx - (p.x - s.a.x) * dy; };
  double t0 = along(other.a), t1 = along(other.b);
  double h0 = aside(other.a), h1 = aside(other.b);
  if (t0 > t1) {
    std::swap(t0, t1);
    std::swap(h0, h1);
  }
  from = std::max(t0, 0.0);
  to = std::min(t1, l);
  if (to - from < std::min(tolerance, 0.5 * l)) return false;
  const double slope = (h1 - h0) / (t1 - t0);
  // Lines that cross at a small angle share only a point.
  const bool whole = (from <= 0.0 && to >= l) || (from <= t0 && to >= t1);
  const double other_l = distance(other.a, other.b);
  if (!whole && std::abs(slope) > kParallel + kAside / std::min(l, other_l)) return false;
  return std::abs(h0 + slope * (from - t0)) <= tolerance &&
         std::abs(h0 + slope * (to - t0)) <= tolerance;
}

OverlapIndex::OverlapIndex(double cell, double tolerance, std::size_t expected)
    : cell_(cell), tolerance_(tolerance), head_(std::bit_ceil(4 * expected + 16), -1) {
  segments_.reserve(expected);
  ids_.reserve(expected);
}

double OverlapIndex::cell_for(std::span<const Segment> segments) {
  if (segments.empty()) return 1.0;
  std::vector<double> lengths;
  lengths.reserve(segments.size());
  double total = 0.0;
  for (const Segment& s : segments) {
    lengths.push_back(distance(s.a, s.b));
    total += lengths.back();
  }
  const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
  std::nth_element(lengths.begin(), middle, lengths.end());
  const double coarse =
      std::max({2.0 * *middle, total / (8.0 * static_cast<double>(segments.size())), 0.1});
  return cell_for_density(
      segments.size(), [&](std::size_t k) { return segments[k]; }, coarse, 0.1);
}

std::size_t OverlapIndex::slot(std::int64_t cx, std::int64_t cy, int direction) const {
  std::uint64_t h = static_cast<std::uint64_t>(cx) * 0x9E3779B97F4A7C15ULL;
  h ^= (static_cast<std::uint64_t>(cy) + static_cast<std::uint64_t>(direction) * 0x51ED27ULL) *
       0xC2B2AE3D27D4EB4FULL;
  h ^= h >> 29;
  h *= 0xBF58476D1CE4E5B9ULL;
  return (h ^ (h >> 32)) & (head_.size() - 1);
}

void OverlapIndex::insert(const Segment& segment, std::uint32_t id) {
  const auto index = static_cast<std::uint32_t>(segments_.size());
  segments_.push_back(segment);
  ids_.push_back(id);
  seen_.push_back(0);
  const int direction = direction_of(segment);
  walk_cells(segment, cell_, 0.0, [&](std::int64_t cx, std::int64_t cy) {
    std::int32_t& head = head_[slot(cx, cy, direction)];
    entries_.emplace_back(index, head);
    head = static_cast<std::int32_t>(entries_.size() - 1);
    return true;
  });
}

void OverlapIndex::covered(const Segment& segment, std::uint32_t not_this,
                           std::vector<Covered>& out) {
  out.clear();
  find(segment, not_this, out);
  std::sort(out.begin(), out.end(), [](const Covered& a, const Covered& b) {
    return a.from != b.from ? a.from < b.from : a.by < b.by;
  });
}

void OverlapIndex::find(const Segment& segment, std::uint32_t not_this, std::vector<Covered>& out) {
  const double l = distance(segment.a, segment.b);
  if (!(l > 0.0) || segments_.empty()) return;
  ++query_;
  const int direction = direction_of(segment);
  walk_cells(segment, cell_, tolerance_, [&](std::int64_t cx, std::int64_t cy) {
    for (int turn = kDirections - 1; turn <= kDirections + 1; ++turn) {
      for (std::int32_t e = head_[slot(cx, cy, (direction + turn) % kDirections)]; e >= 0;
           e = entries_[static_cast<std::size_t>(e)].second) {
        const std::uint32_t index = entries_[static_cast<std::size_t>(e)].first;
        if (seen_[index] == query_ || ids_[index] == not_this) continue;
        seen_[index] = query_;
        ++compared_;
        Covered part{0.0, 0.0, ids_[index]};
        if (overlap(segment, l, segments_[index], tolerance_, part.from, part.to))
          out.push_back(part);
      }
    }
    return true;
  });
}

}  // namespace popcut
