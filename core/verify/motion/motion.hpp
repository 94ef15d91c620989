// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/geometry/buckets.hpp"
#include "core/verify/sheet/check.hpp"
#include "core/verify/sheet/fold_model.hpp"
#include "core/verify/sheet/sheet.hpp"

namespace popcut::verify {

/// A rigid motion of a panel from the flat sheet into space: p -> origin + u * along_u + v *
/// along_v. The three directions are orthonormal and right-handed; `normal` points to the sheet's
/// face side. It is not `rigid::Motion` (a quaternion and a shift): the verifier shares no motion
/// with what it judges, and a quaternion would change the last digits of its figures.
struct PanelMotion {
  Vec3 origin;
  Vec3 along_u{1.0, 0.0, 0.0};
  Vec3 along_v{0.0, 1.0, 0.0};
  Vec3 normal{0.0, 0.0, 1.0};

  [[nodiscard]] Vec3 operator()(Vec2 p) const { return origin + p.x() * along_u + p.y() * along_v; }
};

/// Extrapolates the motion by `by` steps past `to`, where the last step came from `from`, with
/// orthonormal axes. Lengths in mm.
[[nodiscard]] PanelMotion further(const PanelMotion& from, const PanelMotion& to, double by);

/// The vertices of each panel (with repeats), and three vertices far apart by which its motion is
/// measured.
struct Panels {
  Buckets<std::uint32_t> vertices;
  std::vector<std::array<std::uint32_t, 3>> anchors;
};

/// Collects the vertices of each panel of a sheet.
[[nodiscard]] Panels make_panels(const FoldModel& file, const Sheet& sheet);

/// What a pose does to the sheet.
struct PoseMotion {
  std::vector<PanelMotion> panel;       ///< one per panel
  std::vector<double> hinge_angle_deg;  ///< one per hinge of the sheet: + valley, - mountain
  double isometry_mm{};    ///< largest change of an edge's length or of a panel's shape
  double hinge_gap_mm{};   ///< largest distance between the places two panels give a fold end
  double sharpest_deg{};   ///< largest absolute fold angle
  double least_generic{};  ///< smallest |sin| of a fold angle between two panels
  bool bent{};             ///< some fold is neither flat nor shut
  bool shut{};             ///< some fold is shut: 180 degrees
};

/// Fold angles below this count as flat; above 180 minus this, as shut. Degrees.
inline constexpr double kFlatOrShut_deg = 0.01;

/// The name of a pose for messages.
[[nodiscard]] std::string pose_name(const Pose& pose);

/// Measures a pose: the rigid motion of every panel, and how far the pose deviates from rigid
/// panels on closed hinges. Fold angles come from the panels' normals: the angle from the right
/// face's normal to the left face's normal about the fold, with FOLD's sign.
[[nodiscard]] PoseMotion measure(const FoldModel& file, const Sheet& sheet, const Panels& panels,
                                 const Pose& pose);

/// Checks that every panel is rigid and every hinge closed. Names edges whose length changes, and
/// faces that are bent or sheared, by more than `limit_mm`.
void check_isometry(const FoldModel& file, const Sheet& sheet, const Pose& pose,
                    const PoseMotion& motion, double limit_mm, VerifyCheck& check);

/// Checks that the fold angles that the file lists for a pose agree with the pose, in size and
/// sign. `angle_deg` has one entry per edge; NaN is not compared.
/// @return the largest deviation in degrees
double check_fold_angles(const FoldModel& file, const Sheet& sheet, const Pose& pose,
                         const PoseMotion& motion, const std::vector<double>& angle_deg,
                         double limit_deg, VerifyCheck& check);

/// Checks that mountains and valleys turn the way they are assigned. (A flat crease that bends is a
/// panel that bends: `check_isometry` finds it.)
void check_assignments(const FoldModel& file, const Sheet& sheet, const Pose& pose,
                       const PoseMotion& motion, double limit_deg, VerifyCheck& check);

}  // namespace popcut::verify
