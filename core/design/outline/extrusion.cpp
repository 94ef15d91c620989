// SPDX-License-Identifier: MIT
#include "core/design/outline/extrusion.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>

#include "core/geometry/triangulate.hpp"

namespace popcut {
namespace {

/// An area as one closed line: a bridge, walked there and back, joins each hole to what is around
/// it (Eberly, Triangulation by Ear Clipping, 2002, section 3).
class Keyhole {
 public:
  explicit Keyhole(const Area& area) {
    append(area.outline, line_);
    std::vector<const Ring*> holes;
    for (const Ring& hole : area.holes) holes.push_back(&hole);
    // The rightmost first: nothing that is not joined yet lies to the right of it.
    std::sort(holes.begin(), holes.end(),
              [](const Ring* a, const Ring* b) { return right_of(*a) > right_of(*b); });
    for (const Ring* hole : holes) joined_ = joined_ && join(*hole);
  }

  [[nodiscard]] bool joined() const { return joined_; }
  [[nodiscard]] const std::vector<Vec2>& points() const { return points_; }
  [[nodiscard]] const std::vector<std::uint32_t>& line() const { return line_; }

 private:
  static double right_of(const Ring& ring) {
    return std::max_element(ring.begin(), ring.end(),
                            [](const Vec2& a, const Vec2& b) { return a[0] < b[0]; })
        ->x();
  }

  void append(const Ring& ring, std::vector<std::uint32_t>& line) {
    for (const Vec2& p : ring) {
      line.push_back(static_cast<std::uint32_t>(points_.size()));
      points_.push_back(p);
    }
  }

  /// Twice the area of a, b, c; positive where they turn left.
  static double turn(const Vec2& a, const Vec2& b, const Vec2& c) {
    return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
  }

  /// Where, in the line, a corner is that the hole's point `m` sees to its right.
  [[nodiscard]] std::optional<std::size_t> seen_from(const Vec2& m) const {
    const std::size_t n = line_.size();
    const auto at = [&](std::size_t k) -> const Vec2& { return points_[line_[k % n]]; };
    double nearest = std::numeric_limits<double>::infinity();
    std::size_t side = n;
    for (std::size_t k = 0; k < n; ++k) {
      const Vec2 &a = at(k), &b = at(k + 1);
      if (!(a[1] <= m[1] && m[1] <= b[1]) || a[1] == b[1]) continue;  // upward: paper on its left
      const double x = a[0] + (b[0] - a[0]) * (m[1] - a[1]) / (b[1] - a[1]);
      if (x >= m[0] && x < nearest) nearest = x, side = k;
    }
    if (side == n) return std::nullopt;
    const Vec2 hit(nearest, m[1]);
    std::size_t chosen = at(side)[0] > at(side + 1)[0] ? side : (side + 1) % n;
    if (at(side)[1] == m[1]) chosen = side;
    if (at(side + 1)[1] == m[1]) chosen = (side + 1) % n;
    const Vec2 p = at(chosen);
    if (p[1] == m[1]) return chosen;
    // A corner within the triangle m, hit, p hides p: of these the one of least slope is seen.
    const double way = p[1] > m[1] ? 1.0 : -1.0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < n; ++k) {
      const Vec2& q = at(k);
      if (q == p || way * turn(m, hit, q) < 0.0 || way * turn(hit, p, q) < 0.0 ||
          way * turn(p, m, q) < 0.0)
        continue;
      if (turn(at(k + n - 1), q, at(k + 1)) > 0.0) continue;  // only reflex corners hide
      const double slope = way * (q[1] - m[1]) / std::max(q[0] - m[0], 1e-300);
      if (slope < least) least = slope, chosen = k;
    }
    return chosen;
  }

  /// Of the corners at one place, which bridges make, that which has `m` between its sides.
  [[nodiscard]] std::size_t facing(std::size_t corner, const Vec2& m) const {
    const std::size_t n = line_.size();
    const Vec2 p = points_[line_[corner]];
    for (std::size_t k = 0; k < n; ++k) {
      if (points_[line_[k]] != p) continue;
      const Vec2 &before = points_[line_[(k + n - 1) % n]], &after = points_[line_[(k + 1) % n]];
      const bool left_of_in = turn(before, p, m) >= 0.0, left_of_out = turn(p, after, m) >= 0.0;
      const bool convex = turn(before, p, after) > 0.0;
      if (convex ? left_of_in && left_of_out : left_of_in || left_of_out) return k;
    }
    return corner;
  }

  bool join(const Ring& hole) {
    std::vector<std::uint32_t> around;
    const auto right = static_cast<std::size_t>(
        std::max_element(hole.begin(), hole.end(),
                         [](const Vec2& a, const Vec2& b) { return a[0] < b[0]; }) -
        hole.begin());
    const auto seen = seen_from(hole[right]);
    if (!seen) return false;
    const std::size_t bridge = facing(*seen, hole[right]);
    append(hole, around);
    std::rotate(around.begin(), around.begin() + static_cast<std::ptrdiff_t>(right), around.end());
    around.push_back(around.front());
    around.push_back(line_[bridge]);
    line_.insert(line_.begin() + static_cast<std::ptrdiff_t>(bridge) + 1, around.begin(),
                 around.end());
    return true;
  }

  std::vector<Vec2> points_;
  std::vector<std::uint32_t> line_;
  bool joined_{true};
};

class Solid {
 public:
  explicit Solid(double depth) : depth_(depth) {}

  void add_front_and_back(const std::vector<Vec2>& points, const std::vector<Triangle>& triangles) {
    for (const auto& [a, b, c] : triangles) {
      add(depth_, points[a], depth_, points[b], depth_, points[c]);
      add(0.0, points[a], 0.0, points[c], 0.0, points[b]);
    }
  }

  /// The paper lies to the left of the ring.
  void add_sides(const Ring& ring) {
    for (std::size_t k = 0; k < ring.size(); ++k) {
      const Vec2 &a = ring[k], &b = ring[(k + 1) % ring.size()];
      add(0.0, a, 0.0, b, depth_, b);
      add(0.0, a, depth_, b, depth_, a);
    }
  }

  std::vector<float> corners;

 private:
  void add(double xa, const Vec2& a, double xb, const Vec2& b, double xc, const Vec2& c) {
    for (const auto& [x, p] : {std::pair(xa, a), std::pair(xb, b), std::pair(xc, c)}) {
      corners.push_back(static_cast<float>(x));
      corners.push_back(static_cast<float>(p[0]));
      corners.push_back(static_cast<float>(p[1]));
    }
  }
  double depth_;
};

}  // namespace

Result<std::vector<float>> extruded(const std::vector<Area>& areas, double depth) {
  Solid solid(depth);
  std::vector<Triangle> triangles;
  for (const Area& area : areas) {
    const Keyhole keyhole(area);
    triangles.clear();
    if (!keyhole.joined() || !triangulate(keyhole.points(), keyhole.line(), triangles))
      return fail(ErrorKind::Infeasible, "", "a part of it cannot be cut into triangles");
    solid.add_front_and_back(keyhole.points(), triangles);
    solid.add_sides(area.outline);
    for (const Ring& hole : area.holes) solid.add_sides(hole);
  }
  return std::move(solid.corners);
}

}  // namespace popcut
