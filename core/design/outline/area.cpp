// SPDX-License-Identifier: MIT
#include "core/design/outline/area.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <clipper.hpp>

namespace popcut {
namespace {

constexpr double kUnseen = 1e-5;  // of the whole size: 1 micron of a shape of 100 mm
constexpr double kSteps = 1e6;    // over the whole size; products stay far below 2^63

/// A ring of many points without those that it strays from by at most `far` without them (Douglas
/// and Peucker 1973): triangulation takes time as the square of their number.
Ring without_idle_points(const Ring& ring, double far) {
  constexpr std::size_t kMany = 2000;
  const std::size_t n = ring.size();
  if (n < kMany) return ring;
  std::vector<std::uint8_t> kept(n, 0);
  kept[0] = kept[n / 2] = 1;
  std::vector<std::pair<std::size_t, std::size_t>> work{{0, n / 2}, {n / 2, n}};
  while (!work.empty()) {
    const auto [from, to] = work.back();
    work.pop_back();
    const Vec2& a = ring[from];
    const Vec2 way = ring[to % n] - a;
    double most = far;
    std::size_t corner = from;
    for (std::size_t k = from + 1; k < to; ++k) {
      const Vec2 p = ring[k] - a;
      const double t = std::clamp(p.dot(way) / std::max(way.squaredNorm(), 1e-300), 0.0, 1.0);
      const double off = (p - t * way).norm();
      if (off > most) most = off, corner = k;
    }
    if (corner == from) continue;
    kept[corner] = 1;
    work.emplace_back(from, corner);
    work.emplace_back(corner, to);
  }
  Ring out;
  for (std::size_t k = 0; k < n; ++k)
    if (kept[k] != 0) out.push_back(ring[k]);
  return out;
}

Ring ring_of(const ClipperLib::Path& path, const Vec2& from, double step) {
  Ring out;
  out.reserve(path.size());
  for (const ClipperLib::IntPoint& p : path)
    out.push_back(from + step * Vec2(static_cast<double>(p.X), static_cast<double>(p.Y)));
  return out;
}

}  // namespace

Result<std::vector<Area>> areas_within(const std::vector<Ring>& rings, FillRule fill) {
  std::size_t points = 0;
  Eigen::AlignedBox2d box;
  for (const Ring& ring : rings) {
    points += ring.size();
    for (const Vec2& p : ring) {
      if (!p.allFinite())
        return fail(ErrorKind::OutOfRange, "", "has a coordinate that is not a finite number");
      box.extend(p);
    }
  }
  if (points > kMostRingPoints)
    return tl::unexpected(
        too_much(fmt::format("it has {} points; must have at most {}", points, kMostRingPoints)));
  if (points == 0 || !(box.sizes().minCoeff() > 0.0))
    return fail(ErrorKind::Infeasible, "", "has no closed line with an area");
  const double step = box.sizes().maxCoeff() / kSteps;

  ClipperLib::Clipper clipper(ClipperLib::ioStrictlySimple);
  bool any = false;
  for (const Ring& whole : rings) {
    const Ring ring = without_idle_points(whole, kUnseen * box.sizes().maxCoeff());
    ClipperLib::Path path;
    path.reserve(ring.size());
    for (const Vec2& p : ring) {
      const Vec2 at = (p - box.min()) / step;
      path.emplace_back(std::llround(at[0]), std::llround(at[1]));
    }
    any = clipper.AddPath(path, ClipperLib::ptSubject, true) || any;  // false: it has no area
  }
  if (!any) return fail(ErrorKind::Infeasible, "", "has no closed line with an area");
  ClipperLib::PolyTree tree;
  const auto rule = fill == FillRule::EvenOdd ? ClipperLib::pftEvenOdd : ClipperLib::pftNonZero;
  if (!clipper.Execute(ClipperLib::ctUnion, tree, rule, rule))
    return fail(ErrorKind::Malformed, "", "its lines cannot be joined to areas");

  std::vector<Area> out;
  for (const ClipperLib::PolyNode* node = tree.GetFirst(); node; node = node->GetNext()) {
    if (node->IsHole()) continue;
    Area area{ring_of(node->Contour, box.min(), step), {}};
    for (const ClipperLib::PolyNode* hole : node->Childs)
      area.holes.push_back(ring_of(hole->Contour, box.min(), step));
    out.push_back(std::move(area));
  }
  if (out.empty()) return fail(ErrorKind::Infeasible, "", "has no closed line with an area");
  return out;
}

}  // namespace popcut
