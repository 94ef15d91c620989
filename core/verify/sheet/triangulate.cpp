// SPDX-License-Identifier: MIT
#include "core/verify/sheet/triangulate.hpp"

#include <algorithm>
#include <cmath>

namespace popcut::verify {
namespace {

/// The remaining part of a polygon as a ring of corners, with its reflex corners in buckets along
/// the polygon's longer direction.
class Ring {
 public:
  Ring(std::span<const Vec2> points, std::span<const std::uint32_t> polygon)
      : points_(points), polygon_(polygon), left_(polygon.size()) {
    const auto n = static_cast<std::uint32_t>(polygon.size());
    prev_.resize(n);
    next_.resize(n);
    reflex_.assign(n, 0);
    for (std::uint32_t i = 0; i < n; ++i) {
      prev_[i] = (i + n - 1) % n;
      next_[i] = (i + 1) % n;
    }
    Vec2 low = at(0);
    Vec2 high = low;
    for (std::uint32_t i = 1; i < n; ++i) {
      low = {std::min(low.x(), at(i).x()), std::min(low.y(), at(i).y())};
      high = {std::max(high.x(), at(i).x()), std::max(high.y(), at(i).y())};
    }
    along_v_ = high.y() - low.y() > high.x() - low.x();
    low_ = along_v_ ? low.y() : low.x();
    const double length = along_v_ ? high.y() - low.y() : high.x() - low.x();
    per_mm_ = length > 0.0 ? static_cast<double>(n) / length : 0.0;
    sliver_ = 1e-14 * norm(high - low);
    bucket_.resize(n + 1);
    for (std::uint32_t i = 0; i < n; ++i) {
      if (turn(i) >= 0.0) continue;
      reflex_[i] = 1;
      bucket_[slot(at(i))].push_back(i);
    }
  }

  [[nodiscard]] std::size_t left() const { return left_; }
  [[nodiscard]] std::uint32_t next(std::uint32_t i) const { return next_[i]; }
  [[nodiscard]] std::uint32_t prev(std::uint32_t i) const { return prev_[i]; }
  [[nodiscard]] Triangle corner(std::uint32_t i) const {
    return {polygon_[prev_[i]], polygon_[i], polygon_[next_[i]]};
  }
  /// Twice the area of the corner's triangle; negative for a reflex corner.
  [[nodiscard]] double turn(std::uint32_t i) const {
    return cross(at(i) - at(prev_[i]), at(next_[i]) - at(i));
  }
  [[nodiscard]] bool is_sliver(std::uint32_t i) const {
    const double longest = std::max(norm(at(i) - at(prev_[i])), norm(at(next_[i]) - at(i)));
    return std::abs(turn(i)) <= sliver_ * longest;
  }

  /// Whether no reflex corner lies in the triangle at convex corner `i`. Corners on its border
  /// count unless `loose`.
  [[nodiscard]] bool is_ear(std::uint32_t i, bool loose) {
    const Vec2 a = at(prev_[i]);
    const Vec2 b = at(i);
    const Vec2 c = at(next_[i]);
    const auto [low, high] = std::minmax({slot(a), slot(b), slot(c)});
    for (std::size_t s = low; s <= high; ++s) {
      std::vector<std::uint32_t>& bucket = bucket_[s];
      std::erase_if(bucket, [&](std::uint32_t k) { return reflex_[k] == 0; });
      for (const std::uint32_t k : bucket) {
        if (k == prev_[i] || k == i || k == next_[i]) continue;
        const Vec2 p = at(k);
        if (same(p, a) || same(p, b) || same(p, c)) continue;
        const double ab = cross(b - a, p - a);
        const double bc = cross(c - b, p - b);
        const double ca = cross(a - c, p - c);
        const bool in =
            loose ? ab > 0.0 && bc > 0.0 && ca > 0.0 : ab >= 0.0 && bc >= 0.0 && ca >= 0.0;
        if (in) return false;
      }
    }
    return true;
  }

  void clip(std::uint32_t i) {
    next_[prev_[i]] = next_[i];
    prev_[next_[i]] = prev_[i];
    reflex_[i] = 0;
    --left_;
    for (const std::uint32_t k : {prev_[i], next_[i]}) {
      if (reflex_[k] != 0 && turn(k) >= 0.0) reflex_[k] = 0;
      // Next to a zero-width notch, a corner can become reflex when the notch is removed.
      if (reflex_[k] == 0 && turn(k) < 0.0) {
        reflex_[k] = 1;
        bucket_[slot(at(k))].push_back(k);
      }
    }
  }

 private:
  [[nodiscard]] Vec2 at(std::uint32_t i) const { return points_[polygon_[i]]; }
  [[nodiscard]] static bool same(Vec2 a, Vec2 b) { return a.x() == b.x() && a.y() == b.y(); }
  [[nodiscard]] std::size_t slot(Vec2 p) const {
    return static_cast<std::size_t>(std::max(0.0, ((along_v_ ? p.y() : p.x()) - low_) * per_mm_));
  }

  std::span<const Vec2> points_;
  std::span<const std::uint32_t> polygon_;
  std::vector<std::uint32_t> prev_, next_;
  std::vector<std::uint8_t> reflex_;
  std::vector<std::vector<std::uint32_t>> bucket_;
  std::size_t left_{};
  double low_{}, per_mm_{}, sliver_{};
  bool along_v_{};
};

double twice_area(std::span<const Vec2> points, std::span<const std::uint32_t> polygon) {
  double twice = 0.0;
  for (std::size_t k = 1; k + 1 < polygon.size(); ++k) {
    twice +=
        cross(points[polygon[k]] - points[polygon[0]], points[polygon[k + 1]] - points[polygon[0]]);
  }
  return twice;
}

}  // namespace

bool triangulate(std::span<const Vec2> points, std::span<const std::uint32_t> polygon,
                 std::vector<Triangle>& triangles) {
  if (polygon.size() < 3) return false;
  Ring ring(points, polygon);
  std::uint32_t start = 0;
  // Remove zero-width notches first, from their tips, because no ear may reach over them.
  for (std::size_t waited = 0; ring.left() > 2 && waited <= ring.left();) {
    if (ring.is_sliver(start)) {
      ring.clip(start);
      start = ring.prev(start);
      waited = 0;
    } else {
      start = ring.next(start);
      ++waited;
    }
  }
  double covered = 0.0;
  bool loose = false;
  std::size_t waited = 0;
  for (std::uint32_t i = start; ring.left() > 2;) {
    const double turn = ring.turn(i);
    const bool sliver = ring.is_sliver(i);
    if (sliver || (turn > 0.0 && ring.is_ear(i, loose))) {
      if (!sliver) {
        triangles.push_back(ring.corner(i));
        covered += turn;
      }
      ring.clip(i);
      i = ring.next(ring.next(i));  // skip the neighbour, because fans make slivers
      waited = 0;
      loose = false;
      continue;
    }
    i = ring.next(i);
    if (++waited <= ring.left()) continue;
    if (loose) return false;
    loose = true;
    waited = 0;
  }
  const double whole = twice_area(points, polygon);
  return std::abs(covered - whole) <= 1e-9 * std::abs(whole);
}

double common_area(const std::array<Vec2, 3>& a, const std::array<Vec2, 3>& b) {
  // Clips `a` by the three sides of `b`: each side adds at most one corner.
  std::array<Vec2, 6> shape{a[0], a[1], a[2]};
  std::size_t count = 3;
  for (std::size_t side = 0; side < 3 && count > 0; ++side) {
    const Vec2 from = b[side];
    const Vec2 way = b[(side + 1) % 3] - from;
    std::array<Vec2, 6> kept{};
    std::size_t size = 0;
    for (std::size_t k = 0; k < count; ++k) {
      const Vec2 p = shape[k];
      const Vec2 q = shape[(k + 1) % count];
      const double dp = cross(way, p - from);
      const double dq = cross(way, q - from);
      if (dp >= 0.0 && size < kept.size()) kept[size++] = p;
      if ((dp < 0.0) != (dq < 0.0) && size < kept.size())
        kept[size++] = p + (dp / (dp - dq)) * (q - p);
    }
    shape = kept;
    count = size;
  }
  double twice = 0.0;
  for (std::size_t k = 1; k + 1 < count; ++k)
    twice += cross(shape[k] - shape[0], shape[k + 1] - shape[0]);
  return 0.5 * std::abs(twice);
}

}  // namespace popcut::verify
