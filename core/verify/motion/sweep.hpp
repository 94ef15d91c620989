// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/verify/motion/motion.hpp"
#include "core/verify/sheet/fold_model.hpp"
#include "core/verify/sheet/sheet.hpp"

namespace popcut::verify {

/// Poses between flat and shut, of a sheet with one freedom.
struct Sweep {
  std::vector<Pose> poses;  ///< by opening angle, descending
  double from_psi_rad{}, to_psi_rad{};
  std::string stopped;  ///< why it ends before the sheet is shut; empty when it does not
};

/// Moves a sheet of one freedom from a pose to poses over its whole motion, by continuation:
/// panels are rigid, hinges closed. psi is pi less the driving fold's angle (`driving_hinge`); it
/// goes down from nearly flat to nearly shut in steps of `step_rad`, or as far as the panels go.
/// A correction that fails or lands on another branch is tried again in half the step; work is
/// bounded, and large sheets get wider steps.
///
/// @param start     a pose in which some fold is neither flat nor shut, and what it does to panels
/// @param slack_mm  gaps up to this size count as closed: how exact the drawing is
[[nodiscard]] Sweep sweep_motion(const FoldModel& file, const Sheet& sheet, const PoseMotion& start,
                                 double step_rad, double slack_mm);

}  // namespace popcut::verify
