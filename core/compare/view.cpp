// SPDX-License-Identifier: MIT
#include "core/compare/view.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace popcut::likeness {

View view_from(const Vec3& toward) {
  View view;
  view.toward = unit(toward);
  if (!(norm(view.toward) > 0.0)) view.toward = Vec3(1, 0, 0);
  constexpr double kSteep = 1e-6;
  Vec3 right = cross(Vec3(0, 0, 1), view.toward);
  if (norm(right) < kSteep) right = Vec3(0, 1, 0);
  view.right = unit(right);
  view.up = cross(view.toward, view.right);
  return view;
}

std::vector<View> cone_views(double opening_rad) {
  constexpr int kAround = 8;
  const double half = 0.5 * opening_rad;
  const double tilt = std::min(std::numbers::pi / 6, half * 2.0 / 3.0);
  const View diagonal = view_from(Vec3(std::cos(half), 0, std::sin(half)));
  std::vector<View> views{diagonal};
  for (int k = 0; k < kAround; ++k) {
    const double turn = 2.0 * std::numbers::pi * k / kAround;
    const Vec3 aside = std::cos(turn) * diagonal.right + std::sin(turn) * diagonal.up;
    views.push_back(view_from(Vec3(std::cos(tilt) * diagonal.toward + std::sin(tilt) * aside)));
  }
  return views;
}

std::vector<View> page_views() {
  std::vector<View> views;
  for (const double rise_deg : {20.0, 40.0, 60.0})
    for (const double turn_deg : {-40.0, 0.0, 40.0}) {
      const double rise = rise_deg * std::numbers::pi / 180.0,
                   turn = turn_deg * std::numbers::pi / 180.0;
      views.push_back(view_from(
          Vec3(std::cos(rise) * std::cos(turn), std::cos(rise) * std::sin(turn), std::sin(rise))));
    }
  return views;
}

std::vector<View> round_views(std::size_t count) {
  std::vector<View> views;
  for (std::size_t k = 0; k < count; ++k) {
    const double turn =
        2.0 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(count);
    View view;
    view.toward = Vec3(std::cos(turn), 0, std::sin(turn));
    view.up = Vec3(0, 1, 0);  // the spine stands upright, as a book does
    view.right = cross(view.up, view.toward);
    views.push_back(view);
  }
  return views;
}

View risen_view(double turn_rad, double rise_rad) {
  View view;
  view.toward = Vec3(std::cos(turn_rad) * std::cos(rise_rad), std::sin(rise_rad),
                     std::sin(turn_rad) * std::cos(rise_rad));
  view.right = unit(cross(Vec3(0, 1, 0), view.toward));
  view.up = cross(view.toward, view.right);
  return view;
}

Box box_of(Triangles triangles) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  Box box{Vec3(kFar, kFar, kFar), Vec3(-kFar, -kFar, -kFar)};
  std::array<float, 3> low{INFINITY, INFINITY, INFINITY}, high{-INFINITY, -INFINITY, -INFINITY};
  for (std::size_t k = 0; k + 2 < triangles.size(); k += 3)
    for (std::size_t i = 0; i < 3; ++i) {
      low[i] = std::min(low[i], triangles[k + i]);
      high[i] = std::max(high[i], triangles[k + i]);
    }
  for (int i = 0; i < 3; ++i)
    box.low[i] = static_cast<double>(low[i]), box.high[i] = static_cast<double>(high[i]);
  return box;
}

Box joined(const Box& a, const Box& b) { return {a.low.cwiseMin(b.low), a.high.cwiseMax(b.high)}; }

}  // namespace popcut::likeness
