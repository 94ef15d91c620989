// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "core/verify/motion/motion.hpp"
#include "core/verify/sheet/check.hpp"
#include "core/verify/sheet/fold_model.hpp"
#include "core/verify/sheet/sheet.hpp"
#include "core/verify/sheet/tiling.hpp"

namespace popcut::verify {

/// The direction of all folds of a sheet made of rectangular units: every edge is parallel or
/// perpendicular to it, and every fold is parallel. None for any other sheet.
[[nodiscard]] std::optional<Vec2> common_fold_direction(const FoldModel& file, const Sheet& sheet,
                                                        double slack_mm);

/// Whether the panels of a pose lie in only two directions, so that the pose belongs to the affine
/// family `x e1 + z e2(psi)`: if one member has no crossing, no member has one (0 < psi < pi).
[[nodiscard]] bool in_two_directions(const Sheet& sheet, const PoseMotion& motion, Vec2 axis);

/// Checks that the faces of a sheet of rectangular units do not meet in a pose. Exact: between two
/// neighbouring `v` where something begins or ends, the pose is a single section, a set of line
/// segments. These may meet only where the sheet is folded or cut across. O(n log n).
/// @return false if it gave up because of the number of segments; then it has added nothing
[[nodiscard]] bool check_sections(const FoldModel& file, const Sheet& sheet, Vec2 axis,
                                  const PoseMotion& motion, double slack_mm, VerifyCheck& check);

/// Two faces that meet where they must not.
struct MeetingFaces {
  std::uint32_t f{}, g{};
  bool crosses{};        ///< `f` passes through `g`; otherwise both lie in one plane and overlap
  Vec3 where;            ///< a point of the crossing
  double overlap_mm2{};  ///< what they share in one plane
};

struct Meetings {
  std::vector<MeetingFaces> pairs;  ///< the first thousand or so
  bool complete{true};              ///< false: too many faces lie in one place to compare them all
};

/// The faces of any sheet that meet in one pose: one passes through the other by more than
/// `slack_mm`, or both lie in one plane and overlap. In a shut pose, stacks of faces are valid, and
/// only faces that pass through others count.
///
/// @param is_known  whether two panels need not be compared; none: all are
[[nodiscard]] Meetings meeting_faces(
    const FoldModel& file, const Sheet& sheet, const Triangles& triangles, const Pose& pose,
    const PoseMotion& motion, double slack_mm,
    const std::function<bool(std::uint32_t, std::uint32_t)>& is_known = {});

/// Adds a failure for each of `meeting_faces`.
void check_faces_apart(const FoldModel& file, const Sheet& sheet, const Triangles& triangles,
                       const Pose& pose, const PoseMotion& motion, double slack_mm,
                       VerifyCheck& check);

}  // namespace popcut::verify
