// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/geometry/angle.hpp"
#include "core/verify/judge.hpp"

namespace popcut::verify {
namespace {

constexpr double kRightAngle_rad = std::numbers::pi / 2.0;

/// The pose to which the key frame's fold angles belong: the right angle, else the best fitting
/// pose that inherits them. Among the solver's poses it is the one with the listed driving angle; a
/// sheet with several degrees of freedom may not pass it.
std::optional<std::size_t> pose_of_key_angles(const Subject& subject) {
  std::optional<std::size_t> best;
  if (subject.opening) {
    const auto drive_deg = listed_drive_deg(subject);
    if (!drive_deg || subject.mobility.degrees_of_freedom != 1) return {};
    for (std::size_t k = 0; k < subject.file.poses.size(); ++k) {
      const Pose& pose = subject.file.poses[k];
      if (pose.opened &&
          std::abs((std::numbers::pi - *pose.psi_rad) * kDegrees - *drive_deg) < 1e-9)
        best = k;
    }
    return best;
  }
  double least = 0.0;
  for (std::size_t k = 0; k < subject.motions.size(); ++k) {
    const Pose& pose = subject.file.poses[k];
    if (pose.psi_rad && std::abs(*pose.psi_rad - kRightAngle_rad) < 1e-6) return k;
    if (subject.motions[k].sharpest_deg <= kFlatOrShut_deg || !pose.fold_angle_deg.empty())
      continue;
    VerifyCheck scratch;
    const double off = check_fold_angles(subject.file, subject.sheet, pose, subject.motions[k],
                                         subject.file.fold_angle_deg, 360.0, scratch);
    if (!best || off < least) {
      best = k;
      least = off;
    }
  }
  return best;
}

/// The length-weighted median of the folds' absolute angles, in degrees.
double middle_angle_deg(const Subject& subject, const PoseMotion& motion) {
  std::vector<std::pair<double, double>> folds;  // angle and length
  double whole = 0.0;
  for (std::size_t h = 0; h < subject.sheet.hinges.size(); ++h) {
    const Hinge& hinge = subject.sheet.hinges[h];
    if (joins(subject.file.assignment[hinge.edge])) continue;
    const double length = norm(subject.file.flat[hinge.to] - subject.file.flat[hinge.from]);
    folds.emplace_back(std::abs(motion.hinge_angle_deg[h]), length);
    whole += length;
  }
  std::sort(folds.begin(), folds.end());
  for (const auto& [angle, length] : folds) {
    whole -= 2.0 * length;
    if (whole <= 0.0) return angle;
  }
  return 0.0;
}

/// Checks the opening angles that frames state. The opening angle is pi minus the driving fold's
/// angle; on a lattice, minus the angle of most folds.
void check_opening_angles(const Subject& subject, VerifyCheck& check) {
  const auto driver = driving_hinge(subject.file, subject.sheet);
  if (!driver) return;
  for (std::size_t k = 0; k < subject.file.poses.size(); ++k) {
    const Pose& pose = subject.file.poses[k];
    if (!pose.psi_rad || pose.opened) continue;
    const PoseMotion& motion = subject.motions[k];
    const double stated_deg = (std::numbers::pi - *pose.psi_rad) * kDegrees;
    const double shown_deg = std::abs(motion.hinge_angle_deg[*driver]);
    const double limit = subject.limits.angle_deg;
    if (std::abs(shown_deg - stated_deg) <= limit ||
        std::abs(middle_angle_deg(subject, motion) - stated_deg) <= limit) {
      continue;
    }
    check.fail(
        pose.place + "/frame_popcut:psi_rad",
        fmt::format("the frame states {:.6g} rad, but the driving fold, edge {}, is open to {:.6g} "
                    "rad",
                    *pose.psi_rad, subject.sheet.hinges[*driver].edge,
                    std::numbers::pi - shown_deg / kDegrees));
  }
}

}  // namespace

VerifyCheck judge_angles(const Subject& subject, VerifyReport& report) {
  VerifyCheck check = named("fold_angles");
  const FoldModel& file = subject.file;
  std::size_t compared = 0;
  const auto compare = [&](const Pose& pose, const PoseMotion& motion,
                           const std::vector<double>& angle_deg) {
    ++compared;
    const double off = check_fold_angles(file, subject.sheet, pose, motion, angle_deg,
                                         subject.limits.angle_deg, check);
    report.fold_angle_deg = std::max(report.fold_angle_deg, off);
  };
  if (!file.fold_angle_deg.empty()) {
    for (std::uint32_t e = 0; e < file.edges.size(); ++e) {
      const double angle = file.fold_angle_deg[e];
      const bool wrong = (file.assignment[e] == Assignment::Mountain && angle > 0.0) ||
                         (file.assignment[e] == Assignment::Valley && angle < 0.0);
      if (!wrong) continue;
      check.fail(
          fmt::format("/edges_foldAngle/{}", e),
          fmt::format(
              "{:.6g} degrees are listed for a {}; valleys must be positive, mountains negative",
              angle, angle > 0.0 ? "mountain" : "valley"));
    }
    if (const auto k = pose_of_key_angles(subject)) {
      Pose key = file.poses[*k];
      key.fold_angle_deg.clear();
      compare(key, subject.motions[*k], file.fold_angle_deg);
    }
  }
  for (std::size_t k = 0; k < file.poses.size(); ++k) {
    if (const Pose& pose = file.poses[k]; !pose.fold_angle_deg.empty())
      compare(pose, subject.motions[k], pose.fold_angle_deg);
    // The solver's poses turn alike along one motion: the last one is enough.
    if (subject.opening && k + 1 < file.poses.size()) continue;
    check_assignments(file, subject.sheet, file.poses[k], subject.motions[k],
                      subject.limits.angle_deg, check);
  }
  check_opening_angles(subject, check);
  check.detail = fmt::format(
      "{} listed sets of fold angles agree with their poses within {:.2g} degrees; folds "
      "turn the way they are assigned",
      compared, report.fold_angle_deg);
  if (!check.ok())
    check.detail = fmt::format("{} wrong; listed angles differ by up to {:.6g} degrees",
                               check.failed, report.fold_angle_deg);
  return check;
}

}  // namespace popcut::verify
