// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/verify/motion/mobility.hpp"
#include "core/verify/motion/motion.hpp"
#include "core/verify/motion/opening.hpp"
#include "core/verify/sheet/fold_model.hpp"
#include "core/verify/sheet/sheet.hpp"
#include "core/verify/sheet/tiling.hpp"
#include "core/verify/verify.hpp"

namespace popcut::verify {

/// How far numbers may be off. popcut writes enough digits for a millionth of a millimetre. Files
/// from other programs are rounded, so their limits depend on their size.
struct Limits {
  double slack_mm{1e-6};  ///< points closer than this are the same
  double isometry_mm{1e-6};
  double angle_deg{1e-4};
};

/// Limits for a file, by the size of what its edges draw (ignoring vertices without edges).
[[nodiscard]] Limits limits_of(const FoldModel& file);

/// A pattern, with everything known about it so far.
struct Subject {
  FoldModel file;
  bool page{};  ///< a drawing: report places as x and y
  Limits limits;
  Sheet sheet;
  Panels panels;
  Triangles triangles;
  std::vector<PoseMotion> motions;      ///< one per pose
  std::optional<Trajectory> opening;    ///< set if the file had no opened pose
  std::optional<std::size_t> count_in;  ///< the pose in which to count degrees of freedom
  Mobility mobility;                    ///< in that pose
  bool has_one_freedom{};               ///< proven without a rank (`is_driven_by_one_fold`)
  bool quick{};                         ///< `VerifyOptions::quick`
};

/// "WHAT near" a place on the sheet, in the coordinates of the file's author.
[[nodiscard]] std::string near_place(const Subject& subject, const char* what, Vec2 p);

/// An empty check with a name.
[[nodiscard]] VerifyCheck named(const char* name);

/// The pose in which to count degrees of freedom: one with bent folds, preferably without folds
/// near flat or shut, then the one nearest to psi = 1.1 rad.
[[nodiscard]] std::optional<std::size_t> pose_to_count_in(const Subject& subject);

/// The size of the driving fold's angle in the key frame, in degrees. None unless it says how far
/// the pattern opens: more than 1 and less than 179.
[[nodiscard]] std::optional<double> listed_drive_deg(const Subject& subject);

/// Adds the checks `pieces`, `faces`, `lines`, `tiling`. `faces` holds what `make_sheet` found.
void judge_flat_sheet(Subject& subject, VerifyCheck faces, VerifyReport& report);
// Each of these makes one check, and adds its figures and notes to the report.
/// `opening`: how the pattern was opened, if that was necessary.
[[nodiscard]] VerifyCheck judge_opening(const Subject& subject, VerifyReport& report);
/// `isometry`.
[[nodiscard]] VerifyCheck judge_motion(const Subject& subject, VerifyReport& report);
/// `fold_angles`: listed angles, assignments and opening angles against the poses.
[[nodiscard]] VerifyCheck judge_angles(const Subject& subject, VerifyReport& report);
/// `degrees_of_freedom`.
[[nodiscard]] VerifyCheck judge_freedoms(const Subject& subject, const VerifyOptions& options,
                                         VerifyReport& report);
/// `crossing`.
[[nodiscard]] VerifyCheck judge_crossing(const Subject& subject, VerifyReport& report);
/// How far panels move in paper (`VerifyReport::wobble`), and a note that names those that move
/// most. Only where all folds are parallel, and of at most 2000 panels.
void measure_wobble(const Subject& subject, VerifyReport& report);

}  // namespace popcut::verify
