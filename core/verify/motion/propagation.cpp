// SPDX-License-Identifier: MIT
#include "core/verify/motion/propagation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/geometry/buckets.hpp"
#include "core/verify/motion/crossing.hpp"
#include "core/verify/sheet/hinge_lines.hpp"

namespace popcut::verify {
namespace {

/// A fold as one of its panels sees it: the other panel, and the place along e1 and e2.
struct Neighbour {
  std::uint32_t panel{};
  std::array<double, 2> place{};
};

/// Follows one system from the first of its affine panels, held at zero.
///
/// @param way  0: the motion along e1, affine over the panels along e2; 1: the other way round
bool reaches_all(const Buckets<Neighbour>& around, const std::vector<std::uint8_t>& along,
                 std::uint8_t way, double slack_mm) {
  std::vector<std::uint8_t> held(along.size(), 0);
  std::vector<std::uint32_t> work;
  std::size_t count = 0;
  const auto hold = [&](std::uint32_t line) {
    held[line] = 1;
    ++count;
    for (const Neighbour& node : around[line]) {
      if (held[node.panel] != 0) continue;
      held[node.panel] = 1;
      ++count;
      for (const Neighbour& next : around[node.panel])
        if (held[next.panel] == 0) work.push_back(next.panel);
    }
  };
  const auto is_determined = [&](std::uint32_t line) {
    std::optional<double> one;
    for (const Neighbour& node : around[line]) {
      if (held[node.panel] == 0) continue;
      const double place = node.place[1 - way];
      if (one && std::abs(place - *one) > slack_mm) return true;
      if (!one) one = place;
    }
    return false;
  };
  const auto first = std::find_if(along.begin(), along.end(),
                                  [way](std::uint8_t direction) { return direction != way; });
  if (first == along.end()) return false;
  hold(static_cast<std::uint32_t>(first - along.begin()));
  while (!work.empty()) {
    const std::uint32_t line = work.back();
    work.pop_back();
    if (held[line] == 0 && is_determined(line)) hold(line);
  }
  return count == along.size();
}

}  // namespace

bool is_driven_by_one_fold(const FoldModel& file, const Sheet& sheet, const PoseMotion& motion,
                           Vec2 axis, double slack_mm) {
  if (sheet.panels < 2 || sheet.pieces != 1 || !in_two_directions(sheet, motion, axis))
    return false;
  const Vec2 square{axis.y(), -axis.x()};
  const auto direction = [&](std::size_t p) -> Vec3 {
    return square.x() * motion.panel[p].along_u + square.y() * motion.panel[p].along_v;
  };
  const Vec3 e1 = direction(0);
  std::optional<Vec3> e2;
  std::vector<std::uint8_t> along(sheet.panels, 0);
  for (std::size_t p = 1; p < sheet.panels; ++p) {
    const Vec3 d = direction(p);
    if (norm(d - e1) <= 1e-6) continue;
    along[p] = 1;
    if (!e2) e2 = d;
  }
  if (!e2) return false;
  const double cosine = dot(e1, *e2), square_sine = 1.0 - cosine * cosine;
  if (!(square_sine > 1e-4)) return false;  // nearly flat or shut
  const std::vector<HingeLine> lines = hinge_lines(file, sheet);
  // A fold between two panels in one direction is flat or shut: not a generic pose.
  if (std::any_of(lines.begin(), lines.end(),
                  [&](const HingeLine& l) { return along[l.left] == along[l.right]; }))
    return false;
  const Buckets<Neighbour> around(sheet.panels, [&](auto&& put) {
    for (const HingeLine& line : lines) {
      const Vec3 at = motion.panel[line.left](line.from);
      const double a = dot(at, e1), b = dot(at, *e2);
      const double x = (a - cosine * b) / square_sine, z = (b - cosine * a) / square_sine;
      put(line.left, Neighbour{line.right, {x, z}});
      put(line.right, Neighbour{line.left, {x, z}});
    }
  });
  return reaches_all(around, along, 0, slack_mm) && reaches_all(around, along, 1, slack_mm);
}

}  // namespace popcut::verify
