// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "core/design/target/surface_spec.hpp"
#include "core/geometry/opening.hpp"
#include "core/model/triangle_mesh.hpp"
#include "core/result.hpp"

namespace popcut {

/// A rotation as a matrix of rows.
using TurnMatrix = std::array<std::array<double, 3>, 3>;

/// R_z R_y R_x for angles about x, y and z in degrees; exact for multiples of 90 degrees.
[[nodiscard]] TurnMatrix turn_of(const std::array<double, 3>& degrees);

/// The degrees about x, y and z of a turn: `turn_of` gives it back but for rounding.
[[nodiscard]] std::array<double, 3> degrees_of(const TurnMatrix& turn);

/// The turn of a placement's points, that about the spine included.
[[nodiscard]] TurnMatrix whole_turn(const TargetPlacement& placement);
/// The shift of a placement's points after that turn, mm.
[[nodiscard]] std::array<double, 3> whole_shift_mm(const TargetPlacement& placement);

/// Turned by `degrees` about one axis of the corner (0: x, 1: y, 2: z) after what `first` says, to
/// a ten-thousandth of a degree.
[[nodiscard]] std::array<double, 3> turned_on(const std::array<double, 3>& first, std::size_t axis,
                                              double degrees);

/// The 24 turns by right angles, each once, in degrees.
[[nodiscard]] std::vector<std::array<double, 3>> right_turns();

/// No turn, and no shift but along the spine; turns about the spine leave a revolution as it is.
[[nodiscard]] bool stays_on_spine(const TargetPlacement& placement);

/// No turn, no shift but along the spine, and a right angle between wall and ground: the slices of
/// an upright surface stay its own.
[[nodiscard]] bool stays_upright(const TargetPlacement& placement);

/// A placement as a map: points of the surface (its own units) to the corner (mm) and back. In the
/// corner x and z are those of the section, (X, Z) of docs/geometry.md, section 2: oblique
/// coordinates along ground and wall, where the placement's design angle is not a right one.
class PlacementMap {
 public:
  explicit PlacementMap(const TargetPlacement& placement);
  [[nodiscard]] std::array<double, 3> to_corner(const std::array<double, 3>& q) const;
  [[nodiscard]] std::array<double, 3> to_surface(const std::array<double, 3>& p) const;

 private:
  std::array<std::array<double, 3>, 3> turn_;  ///< rows; exact for multiples of 90 degrees
  double scale_;
  std::array<double, 3> shift_;
  Opening opening_;
};

/// The mesh in the corner, mm, in the section's coordinates.
///
/// @retval OutOfRange  a coordinate is farther than a kilometre from the corner
[[nodiscard]] Result<TriangleMesh> placed(TriangleMesh mesh, const TargetPlacement& placement);

}  // namespace popcut
