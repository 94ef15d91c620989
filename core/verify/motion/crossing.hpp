// SPDX-License-Identifier: MIT
#pragma once

#include <optional>

#include "core/verify/motion/motion.hpp"
#include "core/verify/sheet/check.hpp"
#include "core/verify/sheet/fold_model.hpp"
#include "core/verify/sheet/sheet.hpp"
#include "core/verify/sheet/tiling.hpp"

namespace popcut::verify {

/// Direction of all folds, for a sheet made of rectangular units: every edge is parallel to it or
/// square to it, and every fold parallel. Nothing for any other sheet.
[[nodiscard]] std::optional<Vec2> common_fold_direction(const FoldModel& file, const Sheet& sheet,
                                                        double slack_mm);

/// True when the panels of a pose lie in two directions only, so that the pose belongs to the
/// affine family `x e1 + z e2(psi)`: embedded in one member is embedded in all (0 < psi < pi).
[[nodiscard]] bool in_two_directions(const Sheet& sheet, const PoseMotion& motion, Vec2 axis);

/// Do the faces of a sheet of rectangular units keep apart in a pose? Exact: between two
/// neighbouring `v` where something begins or ends, the pose is one section, a set of line
/// segments, and those may meet only where the sheet is folded or cut across. O(n log n).
/// @return false when it gave up for the number of segments; nothing is said then
[[nodiscard]] bool check_sections(const FoldModel& file, const Sheet& sheet, Vec2 axis,
                                  const PoseMotion& motion, double slack_mm, VerifyCheck& check);

/// Do the faces of any sheet keep apart in one pose? Two faces fail when one passes through the
/// other by more than `slack_mm`, or both lie in one plane and overlap there. In a shut pose stacks
/// of faces are lawful and only faces that pass through others fail.
void check_faces_apart(const FoldModel& file, const Sheet& sheet, const Triangles& triangles,
                       const Pose& pose, const PoseMotion& motion, double slack_mm,
                       VerifyCheck& check);

}  // namespace popcut::verify
