// SPDX-License-Identifier: MIT
#pragma once

#include <array>

#include "core/geometry/vec.hpp"

namespace popcut::rigid {

// Places in space are (x, v, z), mm: right-handed, x away from the wall, v along the spine, z up
// (docs/geometry.md, section 2).

/// A rotation as a unit quaternion; its coefficients are (x, y, z, w), in glTF's order.
using Turn = Eigen::Quaterniond;
inline const Turn kNoTurn = Turn::Identity();

/// The same turn with all coefficients of the other sign where that brings it to `side`'s side.
[[nodiscard]] Turn toward(const Turn& turn, const Turn& side);
/// The turn that lies `part` of the way from `a` to `b` on the shorter arc. Eigen's own takes the
/// arc from a cosine, which loses half of the digits of small ones.
[[nodiscard]] Turn slerp(const Turn& a, const Turn& b, double part);

/// Where a rigid body has gone: first the turn about the origin, then the shift.
struct Motion {
  Turn turn{kNoTurn};
  Vec3 shift;

  [[nodiscard]] Vec3 operator()(const Vec3& p) const { return turn * p + shift; }
};

/// The motion that carries the triangle `from` to the congruent triangle `to`.
[[nodiscard]] Motion motion_of(const std::array<Vec3, 3>& from, const std::array<Vec3, 3>& to);

}  // namespace popcut::rigid
