// SPDX-License-Identifier: MIT
#include "core/formats/svg/svg_weld.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>

#include "core/formats/svg/svg_region.hpp"
#include "core/formats/svg/svg_strokes.hpp"
#include "core/geometry/disjoint_sets.hpp"
#include "core/geometry/segment_grid.hpp"

namespace popcut {
namespace {

constexpr double kAcross_mm = 0.01;  // an end this near to a line does not cross it

Box box_of(const LineWork& work, const FilledShape& shape) {
  Box box;
  for (std::size_t i = shape.first; i < shape.first + shape.count; ++i)
    for (const PagePoint& p : work.points_of(work.lines[i])) box.add(p);
  return box;
}

/// How far `p` lies to the left of the line through `s`, mm.
double aside(const Segment& s, const PagePoint& p) {
  const double dx = s.b.x - s.a.x, dy = s.b.y - s.a.y;
  return (dx * (p.y - s.a.y) - dy * (p.x - s.a.x)) / std::max(std::hypot(dx, dy), 1e-12);
}

bool is_across(const Segment& s, const Segment& t, double across_mm) {
  const double a = aside(s, t.a), b = aside(s, t.b);
  return std::min(std::abs(a), std::abs(b)) > across_mm && (a > 0.0) != (b > 0.0);
}

/// Sets of shapes whose boxes overlap, and single ones that may lie over themselves.
std::vector<std::vector<std::size_t>> near_sets(const LineWork& work,
                                                std::span<const FilledShape> shapes,
                                                std::span<const std::uint8_t> crossing,
                                                std::size_t& steps) {
  std::vector<Box> boxes;
  boxes.reserve(shapes.size());
  for (const FilledShape& shape : shapes) boxes.push_back(box_of(work, shape));
  std::vector<std::size_t> by_left(shapes.size());
  std::iota(by_left.begin(), by_left.end(), std::size_t{0});
  std::sort(by_left.begin(), by_left.end(),
            [&](std::size_t a, std::size_t b) { return boxes[a].x0 < boxes[b].x0; });
  DisjointSets sets(shapes.size());
  std::vector<std::size_t> open;  // those that reach as far to the right as where the sweep is
  for (const std::size_t k : by_left) {
    std::erase_if(open, [&](std::size_t o) { return boxes[o].x1 < boxes[k].x0; });
    steps -= std::min(steps, open.size() + 1);
    if (steps == 0) return {};
    for (const std::size_t o : open)
      if (boxes[o].y0 <= boxes[k].y1 && boxes[k].y0 <= boxes[o].y1 &&
          work.lines[shapes[o].first].operation == work.lines[shapes[k].first].operation)
        sets.join(static_cast<std::uint32_t>(o), static_cast<std::uint32_t>(k));
    open.push_back(k);
  }
  std::vector<std::uint32_t> number;
  std::vector<std::vector<std::size_t>> out(sets.number(number));
  for (std::size_t k = 0; k < shapes.size(); ++k) out[number[k]].push_back(k);
  std::erase_if(out, [&](const auto& set) {
    const FilledShape& one = shapes[set.front()];
    return set.size() < 2 &&
           (one.even_odd || (one.count < 2 && (crossing.empty() || crossing[set.front()] == 0)));
  });
  return out;
}

double length_of(const Polylines& lines) {
  double mm = 0.0;
  for (std::size_t i = 0; i < lines.size(); ++i) mm += length(lines[i]);
  return mm;
}

}  // namespace

std::vector<std::uint8_t> crossing_shapes(const LineWork& work, std::span<const FilledShape> shapes,
                                          std::size_t steps, double enlarged) {
  const double across_mm = kAcross_mm / enlarged;
  std::vector<Segment> segments;
  std::vector<std::uint32_t> owners;
  for (std::uint32_t k = 0; k < shapes.size(); ++k)
    for (std::size_t i = shapes[k].first; i < shapes[k].first + shapes[k].count; ++i) {
      const auto points = work.points_of(work.lines[i]);
      for (std::size_t p = 1; p < points.size(); ++p) {
        segments.push_back({points[p - 1], points[p]});
        owners.push_back(k);
      }
    }
  std::vector<std::uint8_t> crosses(shapes.size(), 0);
  SegmentGrid grid(segments, across_mm);
  std::vector<std::uint32_t> near;
  for (std::uint32_t s = 0; s < segments.size(); ++s) {
    if (crosses[owners[s]] != 0) continue;
    near.clear();
    grid.near(segments[s], near);
    if (near.size() >= steps) return {};
    steps -= near.size();
    for (const std::uint32_t t : near)
      if ((owners[t] != owners[s] || (t != s && !shapes[owners[s]].even_odd)) &&
          is_across(segments[s], segments[t], across_mm) &&
          is_across(segments[t], segments[s], across_mm)) {
        crosses[owners[s]] = crosses[owners[t]] = 1;
        break;
      }
  }
  return crosses;
}

std::size_t weld_shapes(LineWork& work, std::span<const FilledShape> shapes,
                        std::span<const std::uint8_t> crossing, std::size_t& steps) {
  std::vector<std::size_t> gone;
  std::size_t joined = 0;
  std::vector<std::pair<PenOperation, Polylines>> welded;
  for (const std::vector<std::size_t>& set : near_sets(work, shapes, crossing, steps)) {
    SvgRegion region;
    std::vector<SvgRegion::Part> parts;
    std::vector<std::size_t> lines;
    double before_mm = 0.0;
    for (const std::size_t k : set) {
      Polylines shape;
      for (std::size_t i = shapes[k].first; i < shapes[k].first + shapes[k].count; ++i) {
        const auto points = work.points_of(work.lines[i]);
        shape.points.insert(shape.points.end(), points.begin(), points.end());
        shape.ends.push_back(static_cast<std::uint32_t>(shape.points.size()));
        lines.push_back(i);
      }
      before_mm += length_of(shape);
      parts.push_back(region.add_shape(shape, shapes[k].even_odd));
    }
    region.finish(region.add_any(std::move(parts)));
    Polylines border = region.border(steps);
    if (steps == 0) return 0;
    if (length_of(border) >= before_mm * (1.0 - 1e-9)) continue;  // they lie apart
    joined += set.size();
    gone.insert(gone.end(), lines.begin(), lines.end());
    welded.emplace_back(work.lines[lines.front()].operation, std::move(border));
  }
  std::sort(gone.begin(), gone.end());
  remove_lines(work, gone);
  for (const auto& [operation, border] : welded)
    for (std::size_t i = 0; i < border.size(); ++i) work.append(operation, border[i]);
  return joined;
}

}  // namespace popcut
