// SPDX-License-Identifier: MIT
#include "core/verify/verify.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "core/geometry/angle.hpp"
#include "core/verify/judge.hpp"
#include "core/verify/motion/crossing.hpp"
#include "core/verify/motion/opening.hpp"
#include "core/verify/motion/propagation.hpp"
#include "core/verify/sheet/fold_model.hpp"
#include "core/verify/sheet/planar.hpp"
#include "core/verify/sheet/sheet.hpp"
#include "core/verify/target/target.hpp"

namespace popcut {
namespace {

using namespace verify;

VerifyCheck check_target(const Subject& subject, const Target& target, VerifyReport& report) {
  VerifyCheck check = named("target");
  if (const auto distances = measure_target(subject.file, target, check)) {
    report.target_inner = distances->inner;
    report.target_all = distances->all;
  }
  return check;
}

/// The opening angles at which to stop: spread over the motion, including the right angle and one
/// beyond it; only up to the listed angle if that is wider open.
std::vector<double> poses_to_open(double listed_deg) {
  std::vector<double> psi{2.6, 2.1, kPi / 2.0, 1.1};
  if (!(listed_deg > 1.0 && listed_deg < 179.0)) return psi;
  const double last = kPi - radians(listed_deg);
  if (std::abs(last - kPi / 2.0) < 1e-9) return psi;
  std::erase_if(psi, [&](double p) { return std::abs(p - last) < 1e-6; });
  if (last > kPi / 2.0) std::erase_if(psi, [&](double p) { return p < last; });
  psi.insert(std::find_if(psi.begin(), psi.end(), [&](double p) { return p < last; }), last);
  return psi;
}

void measure_poses(Subject& subject) {
  subject.panels = make_panels(subject.file, subject.sheet);
  subject.motions.clear();
  for (const Pose& pose : subject.file.poses)
    subject.motions.push_back(measure(subject.file, subject.sheet, subject.panels, pose));
}

/// Separates the sheet along its cuts, opens it with the solver, and adds the poses to those of the
/// file.
void open(Subject& subject) {
  if (part_at_cuts(subject.file, subject.sheet) > 0) {
    VerifyCheck reported_before;
    subject.sheet = make_sheet(subject.file, reported_before);
  }
  double listed_deg = 0.0;
  if (const auto driver = driving_hinge(subject.file, subject.sheet);
      driver && !subject.file.fold_angle_deg.empty())
    listed_deg = std::abs(subject.file.fold_angle_deg[subject.sheet.hinges[*driver].edge]);
  subject.opening = open_sheet(subject.file, subject.sheet, poses_to_open(listed_deg),
                               0.5 * subject.limits.isometry_mm);
  for (Pose& pose : subject.opening->poses) subject.file.poses.push_back(std::move(pose));
  measure_poses(subject);
}

/// What is quicker than the rank: a proof of one freedom, or no count where none is demanded.
void prove_freedom(Subject& subject, const VerifyOptions& options) {
  if (!options.degrees_of_freedom) {
    subject.count_in.reset();
    return;
  }
  const auto axis = common_fold_direction(subject.file, subject.sheet, subject.limits.slack_mm);
  subject.has_one_freedom =
      axis && is_driven_by_one_fold(subject.file, subject.sheet, subject.motions[*subject.count_in],
                                    *axis, subject.limits.slack_mm);
  if (!subject.has_one_freedom) return;
  subject.mobility.degrees_of_freedom = 1;
  subject.mobility.hinges = subject.sheet.hinges.size();
  subject.mobility.clear = true;
}

/// Replaces places in a drawing, whose author knows no numbers of edges and faces, by coordinates.
void name_places(const Subject& subject, VerifyReport& report) {
  const FoldModel& file = subject.file;
  for (VerifyCheck& check : report.checks) {
    for (VerifyFailure& failure : check.failures) {
      std::size_t index = 0;
      if (std::sscanf(failure.place.c_str(), "/edges_vertices/%zu", &index) == 1 &&
          index < file.edges.size()) {
        const auto [a, b] = file.edges[index];
        failure.place = near_place(subject, "the line", 0.5 * (file.flat[a] + file.flat[b]));
      } else if (std::sscanf(failure.place.c_str(), "/faces_vertices/%zu", &index) == 1 &&
                 index < file.faces()) {
        const auto corners = face_of(file, index);
        Vec2 sum;
        for (const std::uint32_t v : corners) sum = sum + file.flat[v];
        failure.place =
            near_place(subject, "the face", (1.0 / static_cast<double>(corners.size())) * sum);
      }
    }
  }
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
  auto read = read_fold_model(text);
  if (!read) return tl::unexpected(std::move(read.error()));
  return verify_model(std::move(*read), options);
}

Result<VerifyReport> verify_model(FoldModel model, const VerifyOptions& options) {
  std::optional<Target> target;
  if (options.target_spec) {
    auto read = read_target(*options.target_spec, options.target_files);
    if (!read) return tl::unexpected(within("target", std::move(read.error())));
    target = std::move(*read);
  }
  Subject subject;
  subject.file = std::move(model);
  subject.page = options.page;
  if (!subject.file.faces_given && subject.file.poses.empty()) {
    if (auto done = planarise(subject.file); !done) return tl::unexpected(done.error());
    subject.file.notes.emplace_back("the drawing lists no faces: they were traced along its lines");
  } else if (!subject.file.faces_given) {
    trace_faces(subject.file);
    subject.file.notes.emplace_back("the file lists no faces: they were traced along its edges");
  }
  subject.limits = limits_of(subject.file);
  if (subject.file.faces() == 0) {
    return fail(ErrorKind::OutOfRange, "/faces_vertices",
                "the edges enclose no face, so there is no sheet; close the outline");
  }

  // Not of equal length; the order of their counts says how far it is.
  constexpr double kStages = 9;
  double stage = 0;
  const auto now = [&](std::string_view what) { tell(options.progress, what, stage++ / kStages); };
  now("checking the sheet");
  VerifyCheck faces = named("faces");
  subject.sheet = make_sheet(subject.file, faces);
  now("measuring the poses");
  measure_poses(subject);
  now("opening the pattern");
  if (!pose_to_count_in(subject)) open(subject);
  subject.count_in = pose_to_count_in(subject);
  subject.quick = options.quick;
  if (options.quick && subject.count_in) prove_freedom(subject, options);
  if (subject.count_in && !subject.has_one_freedom) {
    const PoseMotion& motion = subject.motions[*subject.count_in];
    now("counting its movements");
    subject.mobility =
        mobility(subject.file, subject.sheet, motion, motion.isometry_mm + motion.hinge_gap_mm);
  }
  VerifyReport report;
  report.notes = subject.file.notes;
  now("checking the flat sheet");
  judge_flat_sheet(subject, std::move(faces), report);
  const auto add = [&](VerifyCheck check) { report.checks.push_back(std::move(check)); };
  now("checking how it opens");
  add(judge_opening(subject, report));
  add(judge_motion(subject, report));
  add(judge_angles(subject, report));
  add(judge_freedoms(subject, options, report));
  now("looking for panels that pass through others");
  add(judge_crossing(subject, report));
  measure_wobble(subject, report);
  if (target) now("measuring the distance from your shape");
  if (target) add(check_target(subject, *target, report));
  if (subject.file.drawn || options.name_coordinates) name_places(subject, report);
  return report;
}

}  // namespace popcut
