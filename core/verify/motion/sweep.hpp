// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "core/verify/motion/motion.hpp"
#include "core/verify/sheet/fold_model.hpp"
#include "core/verify/sheet/sheet.hpp"

namespace popcut::verify {

/// Poses between flat and shut, of a sheet with one degree of freedom.
struct Sweep {
  std::vector<Pose> poses;  ///< sorted by opening angle, descending
  double from_psi_rad{}, to_psi_rad{};
  std::string stopped;  ///< why it ends before the sheet is shut; empty if it does not
};

/// Moves a sheet with one degree of freedom from a pose through its whole motion, by continuation
/// with rigid panels and closed hinges. psi is pi minus the driving fold's angle (`driving_hinge`).
/// It decreases from nearly flat to nearly shut in steps of `step_rad`, or as far as the panels go.
/// If a correction fails or lands on another branch, the step is halved. Work is limited; large
/// sheets get larger steps.
///
/// @param start     a pose in which some fold is neither flat nor shut, and its effect on the
///                  panels
/// @param slack_mm  gaps up to this size count as closed: how exact the drawing is
[[nodiscard]] Sweep sweep_motion(const FoldModel& file, const Sheet& sheet, const PoseMotion& start,
                                 double step_rad, double slack_mm);

}  // namespace popcut::verify
