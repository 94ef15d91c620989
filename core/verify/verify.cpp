// SPDX-License-Identifier: MIT
#include "core/verify/verify.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "core/verify/crossing.hpp"
#include "core/verify/fold_model.hpp"
#include "core/verify/mobility.hpp"
#include "core/verify/motion.hpp"
#include "core/verify/sheet.hpp"
#include "core/verify/target.hpp"
#include "core/verify/tiling.hpp"

namespace popcut {
namespace {

using namespace verify;

constexpr double kGenericPsi_rad =
    1.1;  ///< the opening at which freedoms are counted by preference
constexpr double kRightAngle_rad = std::numbers::pi / 2.0;

/// How far numbers may be off. Popcut writes enough digits for a millionth of a millimetre; files
/// from elsewhere are rounded, so they are measured against their own size.
struct Limits {
  double slack_mm{1e-6};  ///< places closer than this are the same
  double isometry_mm{1e-6};
  double angle_deg{1e-4};
};

Limits limits_of(const FoldFile& file) {
  if (file.from_popcut) return {};
  double reach = 0.0;
  for (const Vec2 p : file.flat) reach = std::max(reach, norm(p - file.flat.front()));
  return {.slack_mm = 1e-6 * reach, .isometry_mm = 1e-5 * reach, .angle_deg = 0.1};
}

/// A pattern with all that is known about it so far.
struct Subject {
  FoldFile file;
  Limits limits;
  Sheet sheet;
  Panels panels;
  Triangles triangles;
  std::vector<PoseMotion> motions;  ///< one a pose
};

VerifyCheck named(const char* name) {
  VerifyCheck check;
  check.name = name;
  return check;
}

/// Bent poses in which no fold is near flat or shut come first, then the one nearest to 1.1 rad.
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

void check_pieces(const Subject& subject, VerifyReport& report) {
  VerifyCheck check = named("pieces");
  const Sheet& sheet = subject.sheet;
  report.pieces = sheet.pieces;
  check.detail = fmt::format("{} piece{}, {} rigid faces ({} faces in the file)", sheet.pieces,
                             sheet.pieces == 1 ? "" : "s", sheet.panels, subject.file.faces());
  std::vector<std::size_t> size(sheet.pieces, 0);
  std::vector<std::size_t> first(sheet.pieces, subject.file.faces());
  for (std::size_t f = 0; f < subject.file.faces(); ++f) {
    ++size[sheet.piece_of_face[f]];
    first[sheet.piece_of_face[f]] = std::min(first[sheet.piece_of_face[f]], f);
  }
  const auto largest = std::max_element(size.begin(), size.end()) - size.begin();
  for (std::size_t p = 0; p < sheet.pieces; ++p) {
    if (static_cast<std::ptrdiff_t>(p) == largest) continue;
    check.fail(fmt::format("/faces_vertices/{}", first[p]),
               fmt::format("{} face{} cut off from the rest of the sheet", size[p],
                           size[p] == 1 ? " is" : "s are"));
  }
  report.checks.push_back(std::move(check));
}

/// `faces` has what making the sheet found.
void check_flat_sheet(Subject& subject, VerifyCheck faces, VerifyReport& report) {
  subject.triangles = check_faces(subject.file, faces);
  faces.detail = faces.ok() ? fmt::format("{} simple faces, each fold between two of them",
                                          subject.file.faces())
                            : fmt::format("{} wrong", faces.failed);
  check_pieces(subject, report);
  report.checks.push_back(std::move(faces));

  VerifyCheck lines = named("lines");
  check_lines(subject.file, subject.sheet, subject.limits.slack_mm, lines);
  report.checks.push_back(std::move(lines));

  VerifyCheck tiling = named("tiling");
  const Tiling t =
      check_tiling(subject.file, subject.sheet, subject.triangles, subject.limits.slack_mm, tiling);
  report.checks.push_back(std::move(tiling));
  report.vertices = subject.file.flat.size();
  report.edges = subject.file.edges.size();
  report.fold_faces = subject.file.faces();
  report.faces = subject.sheet.panels;
  report.sheet_u_mm = t.sheet_u_mm;
  report.sheet_v_mm = t.sheet_v_mm;
  report.area_mm2 = t.area_mm2;
  report.slits = t.slits;
  report.holes = t.holes;
}

void check_motion(const Subject& subject, VerifyReport& report) {
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
  report.checks.push_back(std::move(check));
}

/// The pose whose fold angles the key frame lists: the right angle, else of those that inherit them
/// the one that fits best.
std::optional<std::size_t> pose_of_key_angles(const Subject& subject) {
  std::optional<std::size_t> best;
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

void check_angles(const Subject& subject, VerifyReport& report) {
  VerifyCheck check = named("fold_angles");
  const FoldFile& file = subject.file;
  std::size_t compared = 0;
  const auto compare = [&](std::size_t k, const std::vector<double>& angle_deg) {
    ++compared;
    const double off = check_fold_angles(file, subject.sheet, file.poses[k], subject.motions[k],
                                         angle_deg, subject.limits.angle_deg, check);
    report.fold_angle_deg = std::max(report.fold_angle_deg, off);
  };
  if (!file.fold_angle_deg.empty()) {
    for (std::uint32_t e = 0; e < file.edges.size(); ++e) {
      const double angle = file.fold_angle_deg[e];
      const bool wrong = (file.assignment[e] == Assignment::Mountain && angle > 0.0) ||
                         (file.assignment[e] == Assignment::Valley && angle < 0.0);
      if (!wrong) continue;
      check.fail(fmt::format("/edges_foldAngle/{}", e),
                 fmt::format(
                     "{:.6g} degrees are listed for a {}; valleys are positive, mountains negative",
                     angle, angle > 0.0 ? "mountain" : "valley"));
    }
    if (const auto k = pose_of_key_angles(subject)) {
      Pose key = file.poses[*k];
      VerifyCheck listed = named("");
      ++compared;
      key.fold_angle_deg.clear();
      const double off = check_fold_angles(file, subject.sheet, key, subject.motions[*k],
                                           file.fold_angle_deg, subject.limits.angle_deg, listed);
      report.fold_angle_deg = std::max(report.fold_angle_deg, off);
      for (VerifyFailure& failure : listed.failures)
        check.fail(std::move(failure.place), std::move(failure.detail));
      check.failed += listed.failed - listed.failures.size();
    }
  }
  for (std::size_t k = 0; k < file.poses.size(); ++k) {
    if (!file.poses[k].fold_angle_deg.empty()) compare(k, file.poses[k].fold_angle_deg);
    check_assignments(file, subject.sheet, file.poses[k], subject.motions[k],
                      subject.limits.angle_deg, check);
  }
  check.detail = fmt::format(
      "{} listed sets of fold angles agree with their poses within {:.2g} degrees; folds "
      "turn as assigned",
      compared, report.fold_angle_deg);
  if (!check.ok())
    check.detail = fmt::format("{} wrong; listed angles are up to {:.6g} degrees off", check.failed,
                               report.fold_angle_deg);
  report.checks.push_back(std::move(check));
}

void check_freedoms(const Subject& subject, std::size_t pose, const VerifyOptions& options,
                    VerifyReport& report) {
  VerifyCheck check = named("degrees_of_freedom");
  const PoseMotion& motion = subject.motions[pose];
  const Mobility m =
      mobility(subject.file, subject.sheet, motion, motion.isometry_mm + motion.hinge_gap_mm);
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
  const std::string& place = subject.file.poses[pose].place;
  if (!m.clear)
    check.fail(place, "the singular values leave no clear gap: the freedoms cannot be told");
  if (motion.least_generic < 0.01) {
    report.notes.push_back(
        "freedoms were counted in a pose with flat or shut folds, where there can be "
        "more than on the way to it");
  }
  const auto wanted = options.degrees_of_freedom;
  if (wanted && *wanted != m.degrees_of_freedom) {
    check.fail(place, fmt::format("{} degrees of freedom where {} {} demanded",
                                  m.degrees_of_freedom, *wanted, *wanted == 1 ? "is" : "are"));
  } else if (!wanted && m.degrees_of_freedom == 0) {
    check.fail(place, "the pattern is rigid in this pose: it has no degree of freedom");
  }
  report.checks.push_back(std::move(check));
}

void check_crossing(const Subject& subject, VerifyReport& report) {
  VerifyCheck check = named("crossing");
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
    if (axis && !motion.shut &&
        check_sections(subject.file, subject.sheet, *axis, motion, slack, check)) {
      affine = affine && in_two_directions(subject.sheet, motion, *axis);
      continue;
    }
    affine = false;
    check_faces_apart(subject.file, subject.sheet, subject.triangles, subject.file.poses[k], motion,
                      slack, check);
    if (motion.shut) {
      report.notes.push_back(
          fmt::format("frame {} has shut folds: the order of its layers is not judged",
                      subject.file.poses[k].place));
    }
  }
  if (looked_at == 0) {
    check.ran = false;
    check.detail = "not looked for: no opened pose keeps the lengths of the sheet";
    report.checks.push_back(std::move(check));
    return;
  }
  report.crossing_method = affine ? "exact" : "sampled";
  check.detail = affine ? std::string("no face meets another: exact, for every 0 < psi < pi")
                        : fmt::format("no face passes through another: sampled in {} pose{}",
                                      looked_at, looked_at == 1 ? "" : "s");
  if (!check.ok()) check.detail = fmt::format("{} wrong", check.failed);
  report.checks.push_back(std::move(check));
}

void check_target(const Subject& subject, const Target& target, VerifyReport& report) {
  VerifyCheck check = named("target");
  measure_target(subject.file, target, report, check);
  report.checks.push_back(std::move(check));
}

}  // namespace

bool VerifyReport::ok() const {
  return std::all_of(checks.begin(), checks.end(), [](const VerifyCheck& c) { return c.ok(); });
}

std::size_t VerifyReport::failed() const {
  std::size_t sum = 0;
  for (const VerifyCheck& check : checks) sum += check.failed;
  return sum;
}

Result<VerifyReport> verify_fold(std::string_view text, const VerifyOptions& options) {
  std::optional<Target> target;
  if (options.target_spec) {
    auto read = read_target(*options.target_spec);
    if (!read) return tl::unexpected<Error>(within("target", std::move(read.error())));
    target = std::move(*read);
  }
  auto read = read_fold(text);
  if (!read) return tl::unexpected<Error>(std::move(read.error()));
  Subject subject;
  subject.file = std::move(*read);
  subject.limits = limits_of(subject.file);
  if (!subject.file.faces_given) {
    trace_faces(subject.file);
    subject.file.notes.emplace_back("the file lists no faces: they were traced along its edges");
  }
  if (subject.file.faces() == 0) {
    return fail(ErrorKind::OutOfRange, "/faces_vertices",
                "the edges enclose no face; there is no sheet");
  }

  VerifyCheck faces = named("faces");
  subject.sheet = make_sheet(subject.file, faces);
  subject.panels = make_panels(subject.file, subject.sheet);
  for (const Pose& pose : subject.file.poses) {
    subject.motions.push_back(measure(subject.file, subject.sheet, subject.panels, pose));
  }
  const auto pose = pose_to_count_in(subject);
  if (!pose) {
    return fail(ErrorKind::OutOfRange, "/file_frames",
                "no frame shows the pattern opened, neither flat nor shut; verify cannot open a "
                "pattern by itself yet, so the file must hold a deployed frame");
  }
  VerifyReport report;
  report.notes = subject.file.notes;
  check_flat_sheet(subject, std::move(faces), report);
  check_motion(subject, report);
  check_angles(subject, report);
  check_freedoms(subject, *pose, options, report);
  check_crossing(subject, report);
  if (target) check_target(subject, *target, report);
  return report;
}

}  // namespace popcut
