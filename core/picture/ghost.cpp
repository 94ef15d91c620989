// SPDX-License-Identifier: MIT
#include "core/picture/ghost.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <unordered_map>
#include <utility>

namespace popcut {
namespace {

using Polygon = std::vector<Vec3>;

/// The part of a convex polygon on the side `axis` <= at, or >= at.
Polygon clipped(const Polygon& polygon, int axis, double at, bool below) {
  Polygon out;
  const double sign = below ? 1 : -1;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const double da = sign * (a[axis] - at), db = sign * (b[axis] - at);
    if (da <= 0) out.push_back(a);
    if ((da < 0 && db > 0) || (da > 0 && db < 0)) out.push_back(a + (b - a) * (da / (da - db)));
  }
  if (out.size() < 3) out.clear();
  return out;
}

/// Twice the area, as a vector along the normal.
Vec3 spanned(const std::array<Vec3, 3>& t) {
  const Vec3 ab = t[1] - t[0], ac = t[2] - t[0];
  return cross(ab, ac);
}

/// Triangles whose normals look out, all turned or none: of a closed target by its volume, of an
/// open one, which falls from wall to ground, away from both.
std::vector<std::array<Vec3, 3>> looking_out(const TriangleSoup& target) {
  std::vector<std::array<Vec3, 3>> out(target.size());
  Vec3 sum = Vec3::Zero();
  double area = 0, volume = 0;
  for (std::size_t t = 0; t < out.size(); ++t) {
    out[t] = {target.corner(t, 0), target.corner(t, 1), target.corner(t, 2)};
    const Vec3 normal = spanned(out[t]), from = out[t][0] - out[0][0];
    sum += normal, area += norm(normal), volume += dot(normal, from);
  }
  const bool is_closed = norm(sum) < 0.01 * area;
  if (is_closed ? volume < 0 : sum[0] + sum[2] < 0)
    for (auto& triangle : out) std::swap(triangle[1], triangle[2]);
  return out;
}

/// What a grid's cell makes of the corners in it.
struct Cell {
  Vec3 sum = Vec3::Zero(), normal = Vec3::Zero();
  double count{};
};

CoarseTarget gathered(const std::vector<std::array<Vec3, 3>>& triangles, const Vec3& low,
                      double cell_mm) {
  std::unordered_map<std::uint64_t, Cell> cells;
  const auto cell_of = [&](const Vec3& p) {
    std::uint64_t key = 0;
    for (int k = 0; k < 3; ++k)
      key = key << 21 | (static_cast<std::uint64_t>((p[k] - low[k]) / cell_mm) & 0x1fffff);
    return key;
  };
  std::vector<std::array<std::uint64_t, 3>> keys;
  std::vector<Vec3> own;
  for (const auto& triangle : triangles) {
    const Vec3 normal = spanned(triangle);
    std::array<std::uint64_t, 3> key{};
    for (std::size_t k = 0; k < 3; ++k) {
      key[k] = cell_of(triangle[k]);
      Cell& cell = cells[key[k]];
      cell.sum += triangle[k], cell.normal += normal, ++cell.count;
    }
    if (key[0] == key[1] || key[1] == key[2] || key[2] == key[0]) continue;
    // Each triangle of cells once: begun with its least one.
    std::rotate(key.begin(), std::min_element(key.begin(), key.end()), key.end());
    keys.push_back(key);
  }
  std::sort(keys.begin(), keys.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  CoarseTarget out;
  for (const auto& key : keys) {
    std::array<Vec3, 3> corners;
    Vec3 normal = Vec3::Zero();
    for (std::size_t k = 0; k < 3; ++k) {
      const Cell& cell = cells[key[k]];
      corners[k] = cell.sum / cell.count;
      const double length = norm(cell.normal);
      if (length > 0) normal += cell.normal / length;
    }
    const double length = norm(normal);
    if (!(length > 0)) continue;
    out.corners.push_back(corners);
    out.normal.push_back(normal / length);
  }
  return out;
}

/// Level panels of a slab: from where to where they reach over the ground, and how high.
struct Level {
  double from{}, to{}, z{};
};

std::vector<Level> levels_of(const Slab& slab) {
  std::vector<Level> out;
  for (const SlabPanel& panel : slab.panels)
    if (panel.place == PanelPlace::Structure && !panel.is_upright)
      out.push_back({0.5 * (panel.low_a.x + panel.high_a.x), 0.5 * (panel.low_b.x + panel.high_b.x),
                     0.5 * (panel.low_a.z + panel.high_a.z)});
  return out;
}

/// Cuts a polygon of a slab at its staircase.
void put_at_staircase(Polygon polygon, double light, const std::vector<Level>& levels,
                      GhostSlab& out) {
  double from = std::numeric_limits<double>::infinity(), to = -from;
  for (const Vec3& p : polygon) from = std::min(from, p[0]), to = std::max(to, p[0]);
  for (const Level& level : levels) {
    if (level.to <= from || level.from >= to || polygon.empty()) continue;
    Polygon under = clipped(polygon, 0, level.to, true);
    polygon = clipped(polygon, 0, level.to, false);
    Polygon in = clipped(under, 2, level.z, true), before = clipped(under, 2, level.z, false);
    if (!in.empty()) out.inside.push_back({std::move(in), light});
    if (!before.empty()) out.outside.push_back({std::move(before), light});
  }
  if (!polygon.empty()) out.outside.push_back({std::move(polygon), light});
}

}  // namespace

CoarseTarget coarse_target(const TriangleSoup& target, std::size_t most_triangles) {
  const auto triangles = looking_out(target);
  if (triangles.empty()) return {};
  Eigen::AlignedBox3d box;
  for (const auto& triangle : triangles)
    for (const Vec3& p : triangle) box.extend(p);
  const double size = norm(Vec3(box.sizes()));
  CoarseTarget out;
  for (double cells = 160; cells > 4; cells *= 0.75) {
    // Off the corner, because regular targets have corners on regular planes, and rounding would
    // tell copies of one corner apart there.
    out = gathered(triangles, box.min() - size / cells * Vec3{0.318, 0.577, 0.123}, size / cells);
    if (out.corners.size() <= most_triangles) break;
  }
  return out;
}

std::vector<GhostSlab> ghost_slabs(const TriangleSoup& target, std::span<const Slab> slabs,
                                   const Vec3& eye, const Vec3& lamp, std::size_t most_triangles) {
  std::vector<GhostSlab> out(slabs.size() + 2);
  if (slabs.empty()) return out;
  const CoarseTarget coarse = coarse_target(target, most_triangles);
  std::vector<std::vector<Level>> levels;
  levels.reserve(slabs.size());
  for (const Slab& slab : slabs) levels.push_back(levels_of(slab));
  for (std::size_t t = 0; t < coarse.corners.size(); ++t) {
    if (dot(coarse.normal[t], eye) <= 0) continue;
    const double light = std::max(0.0, dot(coarse.normal[t], lamp));
    Polygon polygon(coarse.corners[t].begin(), coarse.corners[t].end());
    polygon = clipped(clipped(polygon, 0, 0, false), 2, 0, false);
    if (polygon.empty()) continue;
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const Vec3& p : polygon) low = std::min(low, p[1]), high = std::max(high, p[1]);
    if (low < slabs.front().low_mm)
      if (Polygon part = clipped(polygon, 1, slabs.front().low_mm, true); !part.empty())
        out.front().outside.push_back({std::move(part), light});
    if (high > slabs.back().high_mm)
      if (Polygon part = clipped(polygon, 1, slabs.back().high_mm, false); !part.empty())
        out.back().outside.push_back({std::move(part), light});
    auto s = static_cast<std::size_t>(
        std::partition_point(slabs.begin(), slabs.end(),
                             [&](const Slab& slab) { return slab.high_mm <= low; }) -
        slabs.begin());
    for (; s < slabs.size() && slabs[s].low_mm < high; ++s)
      put_at_staircase(
          clipped(clipped(polygon, 1, slabs[s].low_mm, false), 1, slabs[s].high_mm, true), light,
          levels[s], out[s + 1]);
  }
  return out;
}

}  // namespace popcut
