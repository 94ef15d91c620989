// SPDX-License-Identifier: MIT
#include "core/search/book_standing.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/design/target/placement_map.hpp"
#include "core/search/seen_share.hpp"

namespace popcut {
namespace {

/// The first turn by right angles that has `axis` of the model along the spine.
std::array<double, 3> turn_along_spine(const std::array<int, 3>& axis) {
  for (const auto& degrees : right_turns()) {
    const TurnMatrix turn = turn_of(degrees);
    double along = 0.0;
    for (std::size_t k = 0; k < 3; ++k) along += turn[1][k] * axis[k];
    if (along > 0.5) return degrees;
  }
  return {};
}

}  // namespace

std::vector<std::array<double, 3>> turns_in_book(const UpSide& up, int cards) {
  std::vector<std::array<int, 3>> axes{{0, 0, 1}, {0, 1, 0}, {1, 0, 0}};
  if (up) axes = {*up};
  std::vector<std::array<double, 3>> out;
  for (const auto& axis : axes)
    for (int quarter = 0; quarter < 4; ++quarter)
      out.push_back(turned_on(turn_along_spine(axis), 1, 90.0 * quarter / cards));
  return out;
}

Way way_in_book(const TriangleMesh& model, const std::array<double, 3>& rotate_deg, int cards) {
  Way way = way_of(model, rotate_deg);
  const std::vector<float> standing = standing_in_book(model, way);
  double most = 0.0;
  for (std::size_t k = 0; k + 2 < standing.size(); k += 3)
    most = std::max(
        most, std::hypot(static_cast<double>(standing[k]), static_cast<double>(standing[k + 2])));
  way.shut_reach = most / way.to_target() / std::cos(std::numbers::pi / cards);
  return way;
}

double misfit_in_book(const TriangleMesh& model, const Way& way, int cards) {
  return 1.0 - seen_share({standing_in_book(model, way)}, diagonals_of_book(cards));
}

std::vector<float> standing_in_book(const TriangleMesh& model, const Way& way) {
  std::vector<float> out = standing_model(model, way);
  const double by = 0.5 * way.to_target();
  const auto x = static_cast<float>(by * (way.box.high[0] - way.box.low[0]));
  const auto z = static_cast<float>(by * (way.box.high[2] - way.box.low[2]));
  for (std::size_t k = 0; k + 2 < out.size(); k += 3) out[k] -= x, out[k + 2] -= z;
  return out;
}

}  // namespace popcut
