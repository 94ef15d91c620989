// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/verify/motion/mobility.hpp"
#include "core/verify/motion/motion.hpp"
#include "core/verify/motion/opening.hpp"
#include "core/verify/sheet/fold_model.hpp"
#include "core/verify/sheet/sheet.hpp"
#include "core/verify/sheet/tiling.hpp"
#include "core/verify/verify.hpp"

namespace popcut::verify {

/// How far numbers may be off. Popcut writes enough digits for a millionth of a millimetre; files
/// from elsewhere are rounded, so they are measured against their own size.
struct Limits {
  double slack_mm{1e-6};  ///< places closer than this are the same
  double isometry_mm{1e-6};
  double angle_deg{1e-4};
};

/// Limits for a file, by the size of what its edges draw (vertices of no edge do not count).
[[nodiscard]] Limits limits_of(const FoldModel& file);

/// A pattern with all that is known about it so far.
struct Subject {
  FoldModel file;
  bool page{};  ///< places of a drawing are told as x and y
  Limits limits;
  Sheet sheet;
  Panels panels;
  Triangles triangles;
  std::vector<PoseMotion> motions;      ///< one a pose
  std::optional<Opening> opening;       ///< where the file had no opened pose
  std::optional<std::size_t> count_in;  ///< the pose in which freedoms are counted
  Mobility mobility;                    ///< in that pose
};

/// "WHAT near" a place on the sheet, in the words of who drew it.
[[nodiscard]] std::string near_place(const Subject& subject, const char* what, Vec2 p);

[[nodiscard]] VerifyCheck named(const char* name);

/// The bent pose to count freedoms in: no fold near flat or shut first, then the nearest to 1.1
/// rad.
[[nodiscard]] std::optional<std::size_t> pose_to_count_in(const Subject& subject);

/// The fold angle in degrees that the key frame lists for the driving fold, without its sign, where
/// it says how far the pattern opens: more than 1 and less than 179.
[[nodiscard]] std::optional<double> listed_drive_deg(const Subject& subject);

/// `faces` has what making the sheet found. Adds the checks `pieces`, `faces`, `lines`, `tiling`.
void judge_flat_sheet(Subject& subject, VerifyCheck faces, VerifyReport& report);
/// How the pattern was opened, where it had to be. Adds `opening`.
void judge_opening(const Subject& subject, VerifyReport& report);
/// Adds `isometry`.
void judge_motion(const Subject& subject, VerifyReport& report);
/// Adds `fold_angles`: listed angles, assignments and opening angles against the poses.
void judge_angles(const Subject& subject, VerifyReport& report);
/// Adds `degrees_of_freedom`.
void judge_freedoms(const Subject& subject, const VerifyOptions& options, VerifyReport& report);
/// Adds `crossing`.
void judge_crossing(const Subject& subject, VerifyReport& report);

}  // namespace popcut::verify
