// SPDX-License-Identifier: MIT
#include "core/design/outline/extrusion.hpp"

#include <cstddef>
#include <utility>

#include "core/geometry/triangulate.hpp"

namespace popcut {
namespace {

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

std::vector<float> extruded(const std::vector<Area>& areas, double depth) {
  Solid solid(depth);
  for (const Area& area : areas) {
    std::vector<Vec2> points = area.outline;
    for (const Ring& hole : area.holes) points.insert(points.end(), hole.begin(), hole.end());
    solid.add_front_and_back(points, area.triangles);
    solid.add_sides(area.outline);
    for (const Ring& hole : area.holes) solid.add_sides(hole);
  }
  return std::move(solid.corners);
}

}  // namespace popcut
