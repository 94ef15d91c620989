// SPDX-License-Identifier: MIT
#pragma once

#include "core/verify/motion/motion.hpp"
#include "core/verify/sheet/fold_model.hpp"
#include "core/verify/sheet/sheet.hpp"

namespace popcut::verify {

/// Whether a sheet of rectangular units is proven to have exactly one degree of freedom, in
/// O(panels). False says nothing: then the rank decides (`mobility`).
///
/// All folds are parallel, so every small motion is one of the section, in which a panel lies along
/// e1 or along e2. A panel along e1 moves every point of it alike in e1, and in e2 by an affine
/// function of the place along it; a panel along e2 the other way round. What folds demand thus
/// parts into two systems, one a direction, each of panels with one number and of panels with an
/// affine function. Two folds with known numbers at different places determine a function, which
/// gives all others on its panel. Where that reaches every panel from one of them, each system has
/// the two solutions that are affine over the whole and no other; both together have four, less the
/// three motions of the whole section: one.
///
/// @param axis      direction of all folds on the flat sheet (`common_fold_direction`)
/// @param slack_mm  places closer than this are one place
[[nodiscard]] bool is_driven_by_one_fold(const FoldModel& file, const Sheet& sheet,
                                         const PoseMotion& motion, Vec2 axis, double slack_mm);

}  // namespace popcut::verify
