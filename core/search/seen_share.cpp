// SPDX-License-Identifier: MIT
#include "core/search/seen_share.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/compare/comparison.hpp"
#include "core/design/reached_share.hpp"

namespace popcut {
namespace {

constexpr std::size_t kPoints = 4096;
constexpr int kPixels = 256;
constexpr double kTouch = 0.01;  ///< of the diagonal: what is so near to the nearest is seen

}  // namespace

double seen_share(const TriangleMesh& mesh, std::span<const Vec3> toward) {
  const std::vector<Vec3> points = area_points(mesh, kPoints);
  if (points.empty() || toward.empty()) return 0.0;
  likeness::Scene scene;
  scene.pixels = kPixels;
  for (const Vec3& direction : toward) scene.views.push_back(likeness::view_from(direction));
  const likeness::Target target(mesh.corners, scene);
  const double touch = kTouch * target.box().diagonal();
  std::size_t seen = 0;
  for (const Vec3& p : points) {
    for (std::size_t k = 0; k < scene.views.size(); ++k) {
      const likeness::Frame frame = target.frame(k);
      const Vec3 off = p - frame.centre;
      const auto pixel = [&](double along) {
        return std::clamp(static_cast<int>((along + 0.5 * frame.side_mm) / frame.pitch_mm()), 0,
                          kPixels - 1);
      };
      const auto nearest = static_cast<double>(
          target.image(k).at(pixel(dot(frame.view.right, off)), pixel(dot(frame.view.up, off))));
      // Sides along the eye lie beside the last pixels that show anything.
      if (!std::isfinite(nearest) || dot(frame.view.toward, off) < nearest - touch) continue;
      ++seen;
      break;
    }
  }
  return static_cast<double>(seen) / static_cast<double>(points.size());
}

std::vector<Vec3> diagonals_of_book(int cards, int from, int to) {
  std::vector<Vec3> out;
  for (int k = 0; k < cards; ++k) {
    const double turn = 2.0 * std::numbers::pi * (k + 0.5) / cards;
    Vec3 direction;
    direction[from] = std::cos(turn), direction[to] = std::sin(turn);
    out.push_back(direction);
  }
  return out;
}

double share_of_book(const TriangleMesh& mesh, int cards) {
  double best = 0.0;
  for (int axis = 0; axis < 3; ++axis)
    best =
        std::max(best, seen_share(mesh, diagonals_of_book(cards, (axis + 1) % 3, (axis + 2) % 3)));
  return best;
}

}  // namespace popcut
