// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/pattern/pattern.hpp"
#include "core/result.hpp"
#include "core/rigid/motion.hpp"

namespace popcut {

inline constexpr int kMaxFrames = 10'000;              ///< of one deployment
inline constexpr std::size_t kMaxTabled = 10'000'000;  ///< poses times bodies of one table

/// How every rigid face of a pattern moves: the one source of meshes, animations and pictures.
///
/// A body is a face of the pattern (bodies 0 .. faces - 1), or a link without paper that only
/// carries others (the rest). Motions start from the flat sheet laid open with the spine on the v
/// axis: the place `(u - wall_mm, v, 0)` of the sheet goes to `at(pose, body)(place)`.
///
/// The bodies form a tree of hinges: `pivot` is a point on the hinge with the parent, as a place of
/// the flat sheet, and lies in both at every pose. So a body turns against its parent about a fixed
/// point, and turning alone, joint by joint, gives every motion.
struct PoseTable {
  std::vector<double> psi_rad;
  std::size_t faces{};
  std::vector<std::int32_t> parent;  ///< one a body, -1 for a root
  std::vector<Vec3> pivot;           ///< one a body; a root's is a point that does not move, if any
  std::vector<std::uint32_t> order;  ///< all bodies, each after its parent
  std::vector<rigid::Motion> motions;  ///< bodies() for the first pose, then for the second, ...

  [[nodiscard]] std::size_t bodies() const { return parent.size(); }
  [[nodiscard]] std::size_t poses() const { return psi_rad.size(); }
  [[nodiscard]] const rigid::Motion& at(std::size_t pose, std::size_t body) const {
    return motions[pose * bodies() + body];
  }
};

/// Fills in the places of a pattern's vertices at an opening angle.
using PosedVertices = std::function<void(double psi_rad, std::span<Vec3> places)>;

/// The place of a vertex on the flat sheet, spine on the v axis, wall at negative x.
[[nodiscard]] Vec3 flat_place(const Pattern& pattern, const PatternVertex& vertex);

/// The table of any pattern whose vertices are known at each angle; the motion of each face is
/// found from three of its vertices and checked at all others. Roots are faces that never move
/// where there are any. O(poses x vertices).
///
/// @param slack_mm  how far places may be off a rigid motion, for drawings that are not exact;
///                  1e-7 of the sheet's size always is
/// @retval OutOfRange  an angle is outside 0..pi, or they neither rise nor fall throughout; a face
///                     does not stay rigid (`place` is "faces/N"); more than `kMaxTabled` motions
[[nodiscard]] Result<PoseTable> pose_table(const Pattern& pattern, std::span<const double> psi_rad,
                                           const PosedVertices& positions, double slack_mm = 0);

/// The table by popcut's own law of motion, `posed_vertices`. Here no root shifts either: a panel
/// that hangs on nothing is carried by a link that moves as the wall does.
[[nodiscard]] Result<PoseTable> pose_table(const Pattern& pattern, std::span<const double> psi_rad);

/// How `body` is turned against its parent, or against the world if it is a root.
[[nodiscard]] rigid::Turn joint_turn(const PoseTable& table, std::size_t pose, std::size_t body);

/// Where the pivot of `body` lies in its parent: as an offset from the parent's own pivot, in axes
/// that turn with the parent. For a root: its place in the world at `pose`.
[[nodiscard]] Vec3 joint_place(const PoseTable& table, std::size_t pose, std::size_t body);

/// The poses that an animation needs as keys, first and last among them. Between keys each joint
/// turns by slerp, evenly in psi. Few keys, at most 60 degrees of psi apart, where that gives back
/// every pose of the table to 1e-9 rad and no root shifts (the hinges of panels parallel to wall
/// and ground turn evenly with psi, so there it is exact); else every pose of the table.
[[nodiscard]] std::vector<std::size_t> animation_keys(const PoseTable& table);

/// `frames` angles from `from_rad` to `to_rad`, evenly spaced, both ends exact.
///
/// @retval Usage  no number of frames from 1 to `kMaxFrames`; an angle outside 0..pi; several
///                frames of one angle
[[nodiscard]] Result<std::vector<double>> opening_angles(double from_rad, double to_rad,
                                                         int frames);

}  // namespace popcut
