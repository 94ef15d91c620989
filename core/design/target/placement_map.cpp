// SPDX-License-Identifier: MIT
#include "core/design/target/placement_map.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/geometry/angle.hpp"

namespace popcut {
namespace {

constexpr double kFarthest_mm = 1e6;

using Vec = std::array<double, 3>;

/// Cosine and sine of an angle in degrees, exact at multiples of 90.
std::array<double, 2> cos_sin(double angle_deg) {
  const double quarter = angle_deg / 90.0;
  if (quarter == std::floor(quarter)) {
    const int turns = static_cast<int>(std::fmod(std::fmod(quarter, 4.0) + 4.0, 4.0));
    constexpr std::array<std::array<double, 2>, 4> kExact{{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};
    return kExact[static_cast<std::size_t>(turns)];
  }
  const double angle_rad = radians(angle_deg);
  return {std::cos(angle_rad), std::sin(angle_rad)};
}

TurnMatrix product(const TurnMatrix& a, const TurnMatrix& b) {
  TurnMatrix out{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      for (std::size_t k = 0; k < 3; ++k) out[i][j] += a[i][k] * b[k][j];
  return out;
}

}  // namespace

TurnMatrix turn_of(const Vec& turns_deg) {
  const auto [cx, sx] = cos_sin(turns_deg[0]);
  const auto [cy, sy] = cos_sin(turns_deg[1]);
  const auto [cz, sz] = cos_sin(turns_deg[2]);
  const TurnMatrix x{{{1, 0, 0}, {0, cx, -sx}, {0, sx, cx}}};
  const TurnMatrix y{{{cy, 0, sy}, {0, 1, 0}, {-sy, 0, cy}}};
  const TurnMatrix z{{{cz, -sz, 0}, {sz, cz, 0}, {0, 0, 1}}};
  return product(z, product(y, x));
}

Vec degrees_of(const TurnMatrix& turn) {
  const double sine = std::clamp(-turn[2][0], -1.0, 1.0);
  const bool is_locked = std::abs(sine) > 1.0 - 1e-9;  // then x and z turn about the same axis
  Vec out{is_locked ? std::atan2(-turn[1][2], turn[1][1]) : std::atan2(turn[2][1], turn[2][2]),
          std::asin(sine), is_locked ? 0.0 : std::atan2(turn[1][0], turn[0][0])};
  for (double& angle : out) angle = degrees(angle) + 0.0;
  return out;
}

TurnMatrix whole_turn(const TargetPlacement& placement) {
  const TurnMatrix own = turn_of(placement.rotate_deg);
  if (placement.about_spine_deg == 0.0) return own;
  return product(turn_of({0.0, placement.about_spine_deg, 0.0}), own);
}

Vec whole_shift_mm(const TargetPlacement& placement) {
  if (placement.about_spine_deg == 0.0) return placement.translate_mm;
  const TurnMatrix turn = turn_of({0.0, placement.about_spine_deg, 0.0});
  Vec shift{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k) shift[i] += turn[i][k] * placement.translate_mm[k];
  return shift;
}

Vec turned_on(const Vec& first, std::size_t axis, double degrees) {
  Vec second{};
  second[axis] = degrees;
  Vec out = degrees_of(product(turn_of(second), turn_of(first)));
  for (double& angle : out) angle = std::round(angle * 1e4) / 1e4 + 0.0;
  return out;
}

std::vector<Vec> right_turns() {
  std::vector<Vec> out;
  std::vector<TurnMatrix> seen;
  for (int x = 0; x < 4; ++x)
    for (int y = 0; y < 4; ++y)
      for (int z = 0; z < 4; ++z) {
        const Vec degrees{90.0 * x, 90.0 * y, 90.0 * z};
        const TurnMatrix turn = turn_of(degrees);
        if (std::find(seen.begin(), seen.end(), turn) != seen.end()) continue;
        seen.push_back(turn);
        out.push_back(degrees);
      }
  return out;
}

bool stays_on_spine(const TargetPlacement& placement) {
  return placement.rotate_deg == Vec{} && placement.translate_mm[0] == 0.0 &&
         placement.translate_mm[2] == 0.0;
}

bool stays_upright(const TargetPlacement& placement) {
  return stays_on_spine(placement) && placement.design_angle_deg == 90.0 &&
         placement.about_spine_deg == 0.0;
}

PlacementMap::PlacementMap(const TargetPlacement& placement)
    : turn_(whole_turn(placement)),
      scale_(placement.scale_mm),
      shift_(whole_shift_mm(placement)),
      opening_(DesignAngle::of_deg(placement.design_angle_deg)) {}

Vec PlacementMap::to_corner(const Vec& q) const {
  Vec p{};
  for (std::size_t i = 0; i < 3; ++i)
    p[i] = scale_ * (turn_[i][0] * q[0] + turn_[i][1] * q[1] + turn_[i][2] * q[2]) + shift_[i];
  if (!opening_.is_right()) opening_.to_oblique(p[0], p[2]);
  return p;
}

Vec PlacementMap::to_surface(const Vec& corner) const {
  Vec p = corner;
  if (!opening_.is_right()) opening_.to_space(p[0], p[2]);
  Vec q{};
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t i = 0; i < 3; ++i) q[k] += turn_[i][k] * (p[i] - shift_[i]) / scale_;
  return q;
}

Result<TriangleMesh> placed(TriangleMesh mesh, const TargetPlacement& placement) {
  const PlacementMap map(placement);
  for (std::size_t k = 0; k + 2 < mesh.corners.size(); k += 3) {
    const Vec p = map.to_corner({static_cast<double>(mesh.corners[k]),
                                 static_cast<double>(mesh.corners[k + 1]),
                                 static_cast<double>(mesh.corners[k + 2])});
    for (std::size_t i = 0; i < 3; ++i) {
      if (!(std::abs(p[i]) <= kFarthest_mm))
        return fail(
            ErrorKind::OutOfRange, "/scale_mm",
            fmt::format("triangle {} would reach {:.10g} mm from the corner; at most {:g} mm "
                        "is needed: use a smaller scale_mm, or move it nearer with translate_mm",
                        k / 9, std::abs(p[i]), kFarthest_mm));
      mesh.corners[k + i] = static_cast<float>(p[i]);
    }
  }
  return mesh;
}

}  // namespace popcut
