// SPDX-License-Identifier: MIT
#include "core/verify/motion/sweep.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "core/geometry/angle.hpp"
#include "core/verify/motion/opening.hpp"
#include "core/verify/motion/rigid.hpp"

namespace popcut::verify {
namespace {

/// The flat and the shut state are branch points; the motion is followed up to here.
constexpr double kNearFlat_rad = 0.02;
constexpr double kLastAngle_rad = kPi - 0.02;
constexpr double kShortestSweep_rad = 1e-4;
constexpr double kMostSweepWork = 4e6;  ///< work limit per sheet: unknowns times Gauss-Newton steps
constexpr double kIterationsPerPose = 5.0;

struct Place {
  RigidState state;
  double driven_rad{};
  std::vector<double> angle_rad;
};

/// Follows the single motion of a sheet in one direction.
class Walker {
 public:
  Walker(const RigidSheet& rigid, RigidSolver& solver, std::size_t driver, double sign,
         double slack_mm)
      : rigid_(rigid), solver_(solver), driver_(driver), sign_(sign), slack_mm_(slack_mm) {}

  void begin(RigidState state) {
    before_.reset();
    now_.state = std::move(state);
    note_angles(now_);
    now_.driven_rad = sign_ * now_.angle_rad[driver_];
  }
  [[nodiscard]] const Place& now() const { return now_; }
  [[nodiscard]] bool spent() const {
    return static_cast<double>(solver_.unknowns() * solver_.iterations()) > kMostSweepWork;
  }

  /// Moves to a driving angle. If it cannot, `why` gets the reason.
  bool reach(double driven_rad, std::string& why) {
    double step = std::abs(driven_rad - now_.driven_rad);
    while (std::abs(driven_rad - now_.driven_rad) > 1e-12) {
      const double left = driven_rad - now_.driven_rad;
      const double next =
          std::abs(left) <= step ? driven_rad : now_.driven_rad + std::copysign(step, left);
      double gap = 0.0;
      if (auto place = stepped(next, gap)) {
        before_ = std::exchange(now_, std::move(*place));
        continue;
      }
      step = 0.5 * std::abs(next - now_.driven_rad);
      if (step >= kShortestSweep_rad && !spent()) continue;
      why = spent() ? "it takes too many steps"
                    : fmt::format("hinges would open by {:.2g} mm beyond it", gap);
      return false;
    }
    return true;
  }

 private:
  void note_angles(Place& place) const { place.angle_rad = fold_angles_rad(rigid_, place.state); }

  /// The pose at a nearby driving angle; none if hinges do not close or it is on another branch.
  std::optional<Place> stepped(double driven_rad, double& gap_mm) {
    Place place;
    place.driven_rad = driven_rad;
    place.state = now_.state;
    const double by =
        before_ ? (driven_rad - now_.driven_rad) / (now_.driven_rad - before_->driven_rad) : 0.0;
    for (std::size_t p = 0; before_ && p < place.state.size(); ++p)
      place.state[p] = further(before_->state[p], now_.state[p], by);
    const AngleGoal drive{driver_, sign_ * driven_rad, 1.0};
    const RigidSolver::End end = solver_.correct(place.state, {&drive, 1}, 15);
    gap_mm = end.gap_mm;
    if (end.gap_mm > slack_mm_ || end.goal_off_rad > 1e-6) return {};
    note_angles(place);
    if (!before_) return place;
    for (std::size_t k = 0; k < place.angle_rad.size(); ++k) {
      const double expected = now_.angle_rad[k] + by * (now_.angle_rad[k] - before_->angle_rad[k]);
      const double off = std::abs(std::remainder(place.angle_rad[k] - expected, 2.0 * kPi));
      if (off > 0.05 + std::abs(driven_rad - now_.driven_rad)) return {};
    }
    return place;
  }

  const RigidSheet& rigid_;
  RigidSolver& solver_;
  std::size_t driver_;
  double sign_;
  double slack_mm_;
  Place now_;
  std::optional<Place> before_;
};

}  // namespace

Sweep sweep_motion(const FoldModel& file, const Sheet& sheet, const PoseMotion& start,
                   double step_rad, double slack_mm) {
  Sweep sweep;
  const auto hinge = driving_hinge(file, sheet);
  if (!hinge) return sweep;
  const std::vector<HingeLine> lines = hinge_lines(file, sheet);
  const auto line = std::find_if(lines.begin(), lines.end(),
                                 [&](const HingeLine& l) { return l.hinge == *hinge; });
  const auto driver = static_cast<std::size_t>(line - lines.begin());
  const RigidSheet rigid = rigid_sheet(file, sheet, std::min(line->left, line->right));
  const double sign = fold_angles_rad(rigid, start.panel)[driver] < 0.0 ? -1.0 : 1.0;
  RigidSolver solver(rigid);
  Walker walker(rigid, solver, driver, sign, slack_mm);
  walker.begin(start.panel);
  const double begun_rad = walker.now().driven_rad;
  const double poses =
      kMostSweepWork / (kIterationsPerPose * static_cast<double>(solver.unknowns() + 1));
  const double step = std::max(step_rad, (kLastAngle_rad - kNearFlat_rad) / std::max(poses, 4.0));
  const auto add_pose = [&] {
    sweep.poses.push_back(
        pose_of(file, sheet, walker.now().state, kPi - walker.now().driven_rad, "moved"));
  };
  // 1. From the pose towards the flat sheet.
  std::string ignored;
  for (double at = begun_rad - step;; at -= step) {
    const bool last = at <= kNearFlat_rad;
    if (begun_rad <= kNearFlat_rad || !walker.reach(last ? kNearFlat_rad : at, ignored)) break;
    add_pose();
    if (last) break;
  }
  std::reverse(sweep.poses.begin(), sweep.poses.end());
  // 2. From the pose until the sheet is shut.
  walker.begin(start.panel);
  add_pose();
  for (double at = begun_rad + step;; at += step) {
    const bool last = at >= kLastAngle_rad;
    if (begun_rad >= kLastAngle_rad) break;
    if (!walker.reach(last ? kLastAngle_rad : at, sweep.stopped)) break;
    add_pose();
    if (last) break;
  }
  sweep.from_psi_rad = *sweep.poses.front().psi_rad;
  sweep.to_psi_rad = *sweep.poses.back().psi_rad;
  return sweep;
}

}  // namespace popcut::verify
