// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "core/geometry/angle.hpp"
#include "core/verify/judge.hpp"
#include "core/verify/motion/crossing.hpp"
#include "core/verify/motion/sweep.hpp"

namespace popcut::verify {
namespace {

/// The preferred opening angle for counting degrees of freedom.
constexpr double kGenericPsi_rad = 1.1;
constexpr double kSweepStep_rad = std::numbers::pi / 90.0;

/// The name of an edge for the file's author.
std::string edge_name(const Subject& subject, std::size_t e) {
  if (!subject.file.drawn) return fmt::format("edge {}", e);
  const auto [a, b] = subject.file.edges[e];
  return near_place(subject, "the line", 0.5 * (subject.file.flat[a] + subject.file.flat[b]));
}

/// Whether the file asks for this pose: it lists an angle for every fold, and the pose has them.
bool is_listed(const Subject& subject, const PoseMotion& motion) {
  constexpr double kSame_deg = 1.0;
  const std::vector<double>& listed = subject.file.fold_angle_deg;
  if (listed.empty()) return false;
  for (std::size_t h = 0; h < subject.sheet.hinges.size(); ++h)
    if (!(std::abs(listed[subject.sheet.hinges[h].edge] - motion.hinge_angle_deg[h]) <= kSame_deg))
      return false;
  return true;
}

/// Looks for crossings over the whole motion of a sheet with one degree of freedom, from nearly
/// flat to nearly shut. Returns how far that was, for the report.
std::string judge_sweep(const Subject& subject, double slack_mm, VerifyCheck& check,
                        VerifyReport& report) {
  const Sweep sweep =
      sweep_motion(subject.file, subject.sheet, subject.motions[*subject.count_in], kSweepStep_rad,
                   std::max(0.5 * subject.limits.isometry_mm, report.hinge_gap_mm));
  for (const Pose& pose : sweep.poses) {
    const PoseMotion motion = measure(subject.file, subject.sheet, subject.panels, pose);
    check_faces_apart(subject.file, subject.sheet, subject.triangles, pose, motion, slack_mm,
                      check);
    if (!check.ok()) break;
  }
  if (!sweep.stopped.empty())
    report.notes.push_back(
        fmt::format("the motion was followed only to the opening angle psi {:.4f} rad: {}",
                    sweep.to_psi_rad, sweep.stopped));
  return fmt::format(" and in {} of the whole motion, psi from {:.3g} to {:.3g} rad",
                     sweep.poses.size(), sweep.from_psi_rad, sweep.to_psi_rad);
}

}  // namespace

std::optional<std::size_t> pose_to_count_in(const Subject& subject) {
  std::optional<std::size_t> best;
  std::pair<bool, double> best_rank;
  for (std::size_t k = 0; k < subject.motions.size(); ++k) {
    const PoseMotion& motion = subject.motions[k];
    if (!motion.bent) continue;
    const auto psi = subject.file.poses[k].psi_rad;
    const double far = psi ? std::abs(*psi - kGenericPsi_rad) : 10.0 - motion.least_generic;
    const std::pair rank(motion.least_generic < 0.01, far);
    if (best && !(rank < best_rank)) continue;
    best = k;
    best_rank = rank;
  }
  return best;
}

std::optional<double> listed_drive_deg(const Subject& subject) {
  if (!subject.opening || subject.file.fold_angle_deg.empty()) return {};
  const double angle = std::abs(subject.file.fold_angle_deg[subject.opening->driver_edge]);
  if (!(angle > 1.0 && angle < 179.0)) return {};
  return angle;
}

VerifyCheck judge_opening(const Subject& subject, VerifyReport& report) {
  VerifyCheck check = named("opening");
  if (!subject.opening) {
    check.ran = false;
    check.detail = "not needed: the file has an opened pose";
    return check;
  }
  const Trajectory& opening = *subject.opening;
  report.opening = static_cast<const OpeningFigures&>(opening);
  const auto listed = listed_drive_deg(subject);
  const std::string place = edge_place(opening.driver_edge);
  if (opening.poses.empty()) {
    check.fail(opening.driver_length_mm > 0.0 ? place : "", opening.stopped);
    check.detail = "the flat sheet could not be opened";
  } else {
    check.detail = fmt::format(
        "opened step by step to psi {:.4f} rad: {} steps, {} Gauss-Newton iterations, driven by "
        "{} and the folds in line with it ({:.4g} mm), first guess from {}; hinges closed within "
        "{:.2g} mm",
        opening.reached_psi_rad, opening.steps, opening.iterations,
        edge_name(subject, opening.driver_edge), opening.driver_length_mm, opening.guess,
        opening.gap_mm);
    if (opening.reversed > 0)
      check.fail(place, fmt::format("wrong branch: found no rigid motion in which all folds turn "
                                    "as assigned; in the best one {} turn the other way",
                                    opening.reversed));
    const bool short_of_list = listed && (std::numbers::pi - opening.reached_psi_rad) * kDegrees <
                                             std::min(*listed, 90.0) - 1e-6;
    if (!opening.stopped.empty() && short_of_list)
      check.fail(place, fmt::format("the file lists a fold angle of {:.6g} degrees; {}", *listed,
                                    opening.stopped));
    else if (!opening.stopped.empty())
      report.notes.push_back(fmt::format("the motion ends at the opening angle psi {:.4f} rad: {}",
                                         opening.reached_psi_rad, opening.stopped));
  }
  if (subject.count_in && subject.mobility.degrees_of_freedom > 1)
    report.notes.push_back(fmt::format(
        "the pattern has {} degrees of freedom: of the many ways to open it, this is the "
        "least motion that follows the assignments",
        subject.mobility.degrees_of_freedom));
  for (const std::string& note : opening.notes) report.notes.push_back(note);
  return check;
}

VerifyCheck judge_motion(const Subject& subject, VerifyReport& report) {
  VerifyCheck check = named("isometry");
  for (std::size_t k = 0; k < subject.motions.size(); ++k) {
    const PoseMotion& motion = subject.motions[k];
    report.isometry_mm = std::max(report.isometry_mm, motion.isometry_mm);
    report.hinge_gap_mm = std::max(report.hinge_gap_mm, motion.hinge_gap_mm);
    check_isometry(subject.file, subject.sheet, subject.file.poses[k], motion,
                   subject.limits.isometry_mm, check);
  }
  check.detail = fmt::format(
      "{} poses keep lengths within {:.2g} mm and hinges closed within {:.2g} mm "
      "(limit {:.2g} mm)",
      subject.motions.size(), report.isometry_mm, report.hinge_gap_mm, subject.limits.isometry_mm);
  report.poses = subject.motions.size();
  if (subject.motions.empty()) {
    check.ran = false;
    check.detail = "not measured: the file has no pose";
  }
  return check;
}

VerifyCheck judge_freedoms(const Subject& subject, const VerifyOptions& options,
                           VerifyReport& report) {
  VerifyCheck check = named("degrees_of_freedom");
  if (!subject.count_in) {
    check.ran = false;
    check.detail = subject.quick ? "not counted: no number is required"
                                 : "not counted: all poses are flat or shut";
    return check;
  }
  const std::size_t pose = *subject.count_in;
  const PoseMotion& motion = subject.motions[pose];
  const Mobility& m = subject.mobility;
  report.degrees_of_freedom = m.degrees_of_freedom;
  report.pose_psi_rad = subject.file.poses[pose].psi_rad.value_or(0.0);
  report.hinges = m.hinges;
  report.largest_zero = m.largest_zero;
  report.smallest_nonzero = m.smallest_nonzero;
  report.gap = m.gap;
  report.smallest_singular_values = m.smallest;
  check.detail = fmt::format(
      "{}{} degree{} of freedom; {} hinges; singular values {:.2g} | {:.2g}, gap {:.1g}",
      m.counted ? "" : "at least ", m.degrees_of_freedom, m.degrees_of_freedom == 1 ? "" : "s",
      m.hinges, m.largest_zero, m.smallest_nonzero, m.gap);
  if (subject.has_one_freedom)
    check.detail =
        fmt::format("1 degree of freedom; {} folds; one fold drives all others", m.hinges);
  const std::string& place = subject.file.poses[pose].place;
  if (!m.clear)
    check.fail(
        place,
        "the singular values leave no clear gap, so the degrees of freedom cannot be counted");
  if (motion.least_generic < 0.01)
    report.notes.push_back(
        "degrees of freedom were counted in a pose with flat or shut folds, which can have "
        "more than the poses before it");
  const auto wanted = options.degrees_of_freedom;
  if (wanted && *wanted != m.degrees_of_freedom) {
    check.fail(place, fmt::format("{} degrees of freedom, but {} {} required", m.degrees_of_freedom,
                                  *wanted, *wanted == 1 ? "is" : "are"));
  } else if (!wanted && m.degrees_of_freedom == 0) {
    check.fail(place, "the pattern is rigid in this pose: it has no degrees of freedom");
  }
  return check;
}

VerifyCheck judge_crossing(const Subject& subject, VerifyReport& report) {
  VerifyCheck check = named("crossing");
  VerifyCheck arbitrary;  // crossings in poses that are popcut's choice among many
  const bool many_ways = subject.opening && subject.mobility.degrees_of_freedom > 1;
  const double slack =
      subject.limits.slack_mm + 4.0 * std::min(report.isometry_mm, subject.limits.isometry_mm);
  auto axis = common_fold_direction(subject.file, subject.sheet, subject.limits.slack_mm);
  bool affine = axis.has_value();
  std::size_t looked_at = 0;
  for (std::size_t k = 0; k < subject.motions.size(); ++k) {
    const PoseMotion& motion = subject.motions[k];
    if (!motion.bent) continue;
    if (motion.isometry_mm > subject.limits.isometry_mm) continue;  // not a pose of this sheet
    ++looked_at;
    VerifyCheck& found = many_ways && !is_listed(subject, motion) ? arbitrary : check;
    if (axis && !motion.shut &&
        check_sections(subject.file, subject.sheet, *axis, motion, slack, found)) {
      affine = affine && in_two_directions(subject.sheet, motion, *axis);
      continue;
    }
    affine = false;
    check_faces_apart(subject.file, subject.sheet, subject.triangles, subject.file.poses[k], motion,
                      slack, found);
    if (motion.shut)
      report.notes.push_back(
          fmt::format("{} has shut folds: the order of its layers is not checked",
                      pose_name(subject.file.poses[k])));
  }
  if (looked_at == 0) check.not_judged("no opened pose keeps the lengths of the sheet");
  if (!check.ran) return check;
  if (check.ok() && arbitrary.failed > 0) {
    check.undecided(fmt::format(
        "with {} degrees of freedom the sheet can open in many ways; on the one that was tried, "
        "{}{} pair{} of faces would cross. Add an opened pose to the file, and it is judged in "
        "that pose",
        subject.mobility.degrees_of_freedom, arbitrary.failed >= kMostReported ? "at least " : "",
        arbitrary.failed, arbitrary.failed == 1 ? "" : "s"));
    return check;
  }
  std::string swept;
  if (!affine && !subject.quick && check.ok() && subject.count_in &&
      subject.mobility.degrees_of_freedom == 1)
    swept = judge_sweep(subject, slack, check, report);
  report.crossing_method = affine ? "exact" : "sampled";
  check.detail =
      affine ? std::string("no face meets another: exact, for every opening angle 0 < psi < pi")
             : fmt::format("no face passes through another: checked in {} pose{}{}", looked_at,
                           looked_at == 1 ? "" : "s", swept);
  if (!check.ok()) check.detail = fmt::format("{} wrong", check.failed);
  return check;
}

}  // namespace popcut::verify
