// SPDX-License-Identifier: MIT
#include "core/verify/motion/opening.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include <fmt/format.h>

#include "core/geometry/angle.hpp"
#include "core/verify/motion/rigid.hpp"

namespace popcut::verify {
namespace {

constexpr double kFirstStep_rad = 0.15;
constexpr double kLongestStep_rad = 0.25;
constexpr double kShortestStep_rad = 1e-3;
constexpr double kNearShut_rad = kPi - 0.02;
constexpr double kLargestListed_deg = 178.0;
constexpr std::size_t kDrivers = 3;
constexpr std::size_t kRandomGuesses = 4;
/// Work limit per sheet: unknowns times Gauss-Newton steps.
constexpr double kMostWork = 4e6;
constexpr std::size_t kLeastIterations = 16;  ///< even for the largest sheet

/// What the file says about a line's motion.
struct LineHint {
  int sign{};         ///< +1 valley, -1 mountain, 0 unknown
  double speed{1.0};  ///< relative tangent of half its fold angle, > 0; 0: stays flat
};

std::vector<LineHint> hints_of(const FoldModel& file, const Sheet& sheet, const RigidSheet& rigid) {
  std::vector<LineHint> hints(rigid.lines.size());
  for (std::size_t k = 0; k < hints.size(); ++k) {
    const std::uint32_t e = sheet.hinges[rigid.lines[k].hinge].edge;
    const double angle_deg = file.fold_angle_deg.empty() ? NAN : file.fold_angle_deg[e];
    LineHint& hint = hints[k];
    if (file.assignment[e] == Assignment::Valley) hint.sign = 1;
    if (file.assignment[e] == Assignment::Mountain) hint.sign = -1;
    if (std::isnan(angle_deg)) continue;
    if (hint.sign == 0 && angle_deg != 0.0) hint.sign = angle_deg > 0.0 ? 1 : -1;
    hint.speed = std::tan(0.5 * std::min(std::abs(angle_deg), kLargestListed_deg) / kDegrees);
  }
  return hints;
}

/// The lines by length, longest first; valleys before other lines of the same length.
std::vector<std::size_t> drivers_of(const FoldModel& file, const Sheet& sheet,
                                    const std::vector<HingeLine>& lines) {
  std::vector<std::size_t> order(lines.size());
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
  double longest = 0.0;
  for (const HingeLine& line : lines) longest = std::max(longest, norm(line.to - line.from));
  const auto rank = [&](std::size_t k) {
    const Assignment a = file.assignment[sheet.hinges[lines[k].hinge].edge];
    // Compare lengths in steps of a thousandth of the longest, so that rounding does not decide.
    const double length = std::round(1e3 * norm(lines[k].to - lines[k].from) / longest);
    const int kind = a == Assignment::Valley ? 0 : a == Assignment::Mountain ? 1 : 2;
    return std::tuple(-length, kind, k);
  };
  const auto count = std::min(order.size(), kDrivers);
  std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count), order.end(),
                    [&](std::size_t a, std::size_t b) { return rank(a) < rank(b); });
  order.resize(count);
  return order;
}

/// Converts half-angle tangents to angles.
std::vector<double> angles_of(const std::vector<double>& tangent) {
  std::vector<double> angle(tangent.size());
  for (std::size_t k = 0; k < angle.size(); ++k) angle[k] = 2.0 * std::atan(tangent[k]);
  return angle;
}

/// A guess of how the sheet leaves the flat state: half-angle tangents of all lines, with 1 for the
/// driver.
struct Guess {
  std::string name;
  std::vector<double> tangent;
};

std::vector<Guess> guesses_for(const std::vector<LineHint>& hints, std::size_t driver,
                               bool has_angles) {
  const double lead = hints[driver].sign == 0 ? 1.0 : hints[driver].sign;
  std::vector<Guess> guesses;
  const auto add = [&](std::string name, auto speed) {
    std::vector<double> tangent(hints.size());
    for (std::size_t k = 0; k < tangent.size(); ++k) tangent[k] = speed(k);
    tangent[driver] = lead;
    guesses.push_back({std::move(name), std::move(tangent)});
  };
  const double of_driver = hints[driver].speed > 1e-3 ? hints[driver].speed : 1.0;
  if (has_angles)
    add("the listed fold angles",
        [&](std::size_t k) { return hints[k].sign * std::min(hints[k].speed / of_driver, 50.0); });
  add("the assignments", [&](std::size_t k) { return 1.0 * hints[k].sign; });
  std::mt19937 random(20261121);
  for (std::size_t round = 0; round < kRandomGuesses; ++round) {
    std::uniform_real_distribution<double> power(-1.2, 1.2);
    add("the assignments, with random speeds", [&](std::size_t k) {
      const double sign = hints[k].sign != 0 ? hints[k].sign : random() % 2 == 0 ? 1.0 : -1.0;
      return sign * std::exp(power(random));
    });
  }
  return guesses;
}

/// A pose on the way.
struct Point {
  RigidState state;
  double driven_rad{};  ///< absolute driving fold angle
  std::vector<double> tangent;
};

/// Follows the motion of one driving line.
class Follower {
 public:
  Follower(const RigidSheet& rigid, const std::vector<LineHint>& hints, RigidSolver& solver,
           std::size_t driver, double slack_mm)
      : rigid_(rigid), hints_(hints), solver_(solver), driver_(driver), slack_mm_(slack_mm) {
    lead_ = hints[driver].sign == 0 ? 1.0 : hints[driver].sign;
  }

  /// Leaves the flat state. If it cannot, `why` gets the reason.
  bool leave(bool has_angles, std::string& guess_name, std::string& why);
  /// Continues to a fold angle of the driver. If it cannot, `why` gets the reason.
  bool reach(double driven_rad, std::string& why);

  [[nodiscard]] const Point& now() const { return now_; }
  [[nodiscard]] double gap_mm() const { return gap_mm_; }
  [[nodiscard]] std::size_t steps() const { return steps_; }
  [[nodiscard]] std::size_t unfolded() const { return unfolded_; }
  [[nodiscard]] std::size_t reversed() const { return reversed_; }
  /// Whether the work limit of a sheet is used up.
  [[nodiscard]] bool spent() const {
    return static_cast<double>(solver_.unknowns() * solver_.iterations()) > kMostWork &&
           solver_.iterations() > kLeastIterations;
  }

 private:
  /// How well a pose near the flat state follows the assignments.
  struct Fit {
    std::size_t reversed{}, unfolded{};
    [[nodiscard]] std::size_t worst() const { return reversed * 1000 + unfolded; }
  };
  [[nodiscard]] RigidState drawn(const Guess& guess, double driven_rad);
  [[nodiscard]] Fit fit_of(const std::vector<double>& angle_rad, double driven_rad) const;
  [[nodiscard]] RigidState predicted(double driven_rad, std::vector<double>& tangent) const;
  void accept(RigidState state, double driven_rad, double gap);
  [[nodiscard]] std::string shut_line() const;

  const RigidSheet& rigid_;
  const std::vector<LineHint>& hints_;
  RigidSolver& solver_;
  std::size_t driver_;
  double slack_mm_;
  double lead_{1.0};
  Point now_, before_;
  double gap_mm_{};
  std::size_t steps_{}, unfolded_{}, reversed_{};
};

/// Folds the panels by a guess and pulls them onto closed hinges, with less and less weight on the
/// guess.
RigidState Follower::drawn(const Guess& guess, double driven_rad) {
  std::vector<double> tangent = guess.tangent;
  for (double& t : tangent) t *= std::tan(0.5 * driven_rad);
  const std::vector<double> angle = angles_of(tangent);
  RigidState state = state_from_tree(rigid_, angle);
  const AngleGoal drive{driver_, lead_ * driven_rad, 1.0};
  const double gap = largest_gap_mm(rigid_, state);
  if (gap <= slack_mm_) return state;
  if (gap > 0.1 * driven_rad * rigid_.reach_mm) state.assign(state.size(), PanelMotion{});
  std::vector<AngleGoal> goals;
  for (std::size_t k = 0; k < angle.size(); ++k) {
    if (guess.tangent[k] != 0.0 && k != driver_) goals.push_back({k, angle[k], 0.0});
  }
  goals.push_back(drive);
  for (const double weight : {0.3, 0.1, 0.03, 0.01, 0.001}) {
    for (AngleGoal& goal : goals)
      if (goal.line != driver_) goal.weight = weight;
    (void)solver_.correct(state, goals, 4, 1e-9);
    if (spent()) break;
  }
  return state;
}

Follower::Fit Follower::fit_of(const std::vector<double>& angle_rad, double driven_rad) const {
  Fit fit;
  for (std::size_t k = 0; k < angle_rad.size(); ++k) {
    if (hints_[k].sign == 0) continue;
    const double turn = hints_[k].sign * angle_rad[k];
    if (turn < -1e-3 * driven_rad) ++fit.reversed;
    if (std::abs(turn) <= 1e-3 * driven_rad && hints_[k].speed > 1e-6) ++fit.unfolded;
  }
  return fit;
}

void Follower::accept(RigidState state, double driven_rad, double gap) {
  before_ = std::move(now_);
  now_.state = std::move(state);
  now_.driven_rad = driven_rad;
  now_.tangent = fold_angles_rad(rigid_, now_.state);
  for (double& t : now_.tangent) t = std::tan(0.5 * std::clamp(t, -3.13, 3.13));
  gap_mm_ = gap;
}

bool Follower::leave(bool has_angles, std::string& guess_name, std::string& why) {
  const auto guesses = guesses_for(hints_, driver_, has_angles);
  double least_gap = INFINITY;
  std::optional<std::pair<RigidState, double>> best;
  Fit best_fit;
  double best_gap = 0.0;
  for (const Guess& guess : guesses) {
    for (const double driven : {kFirstStep_rad, kFirstStep_rad / 4.0}) {
      RigidState state = drawn(guess, driven);
      const AngleGoal drive{driver_, lead_ * driven, 1.0};
      const RigidSolver::End end = solver_.correct(state, {&drive, 1}, 30);
      if (end.goal_off_rad <= 1e-6) least_gap = std::min(least_gap, end.gap_mm);
      if (end.gap_mm <= slack_mm_ && end.goal_off_rad <= 1e-6) {
        const Fit fit = fit_of(fold_angles_rad(rigid_, state), driven);
        if (!best || fit.worst() < best_fit.worst()) {
          best = {std::move(state), driven};
          best_fit = fit;
          best_gap = end.gap_mm;
          guess_name = guess.name;
        }
        if (fit.worst() == 0) break;
      }
      if (spent()) break;
    }
    if (spent() || (best && best_fit.worst() == 0)) break;
  }
  if (!best) {
    why = fmt::format(
        "the flat sheet does not open with rigid panels: with the driving fold at {:.1f} degrees, "
        "hinges stay open by {:.2g} mm",
        kFirstStep_rad * kDegrees, least_gap);
    if (!std::isfinite(least_gap)) why = "the flat sheet does not open: the driving fold is locked";
    return false;
  }
  unfolded_ = best_fit.unfolded;
  reversed_ = best_fit.reversed;
  accept(std::move(best->first), best->second, best_gap);
  return true;
}

RigidState Follower::predicted(double driven_rad, std::vector<double>& tangent) const {
  // 1. Half-angle tangents relative to the driver's, along the last two poses or from the flat
  // state.
  const double lead = std::tan(0.5 * driven_rad);
  const double last = std::tan(0.5 * now_.driven_rad);
  const bool two = !before_.tangent.empty();
  const double first = two ? std::tan(0.5 * before_.driven_rad) : 0.0;
  const double by = (lead - last) / (last - first);
  tangent = now_.tangent;
  for (std::size_t k = 0; k < tangent.size(); ++k)
    tangent[k] += by * (now_.tangent[k] - (two ? before_.tangent[k] : 0.0));
  RigidState by_tree = state_from_tree(rigid_, angles_of(tangent));
  const double gap = largest_gap_mm(rigid_, by_tree);
  if (gap <= slack_mm_ || !two) return by_tree;
  // 2. Or each panel's own motion, if angle errors add up too much along the tree.
  RigidState by_panel = now_.state;
  const double step = (driven_rad - now_.driven_rad) / (now_.driven_rad - before_.driven_rad);
  for (std::size_t p = 0; p < by_panel.size(); ++p)
    by_panel[p] = further(before_.state[p], now_.state[p], step);
  return gap <= largest_gap_mm(rigid_, by_panel) ? by_tree : by_panel;
}

std::string Follower::shut_line() const {
  for (std::size_t k = 0; k < rigid_.lines.size(); ++k) {
    if (k != driver_ && std::abs(now_.tangent[k]) >= std::tan(0.5 * kNearShut_rad)) {
      const Vec2 at = 0.5 * (rigid_.lines[k].from + rigid_.lines[k].to);
      return fmt::format("the fold near ({:.4g}, {:.4g}) is shut", at.x(), at.y());
    }
  }
  return {};
}

bool Follower::reach(double driven_rad, std::string& why) {
  double step = kLongestStep_rad;
  while (std::abs(now_.driven_rad - driven_rad) > 1e-12) {
    if (why = shut_line(); !why.empty()) return false;
    const double left = driven_rad - now_.driven_rad;
    const double next =
        std::abs(left) <= step ? driven_rad : now_.driven_rad + std::copysign(step, left);
    std::vector<double> expected;
    RigidState state = predicted(next, expected);
    const AngleGoal drive{driver_, lead_ * next, 1.0};
    const RigidSolver::End end = solver_.correct(state, {&drive, 1}, 20);
    bool good = end.gap_mm <= slack_mm_ && end.goal_off_rad <= 1e-6;
    if (good) {
      const std::vector<double> angle = fold_angles_rad(rigid_, state);
      for (std::size_t k = 0; k < angle.size() && good; ++k) {
        const double off = std::abs(angle[k] - 2.0 * std::atan(expected[k]));
        good = std::min(off, 2 * kPi - off) <= 0.1 + std::abs(next - now_.driven_rad);
      }
    }
    if (good) {
      ++steps_;
      accept(std::move(state), next, end.gap_mm);
      step = std::min(kLongestStep_rad, 1.5 * step);
      continue;
    }
    step = 0.5 * std::abs(next - now_.driven_rad);
    if (step < kShortestStep_rad || spent()) {
      why = fmt::format(
          "the driving fold stops at {:.2f} degrees, because hinges would "
          "open by {:.2g} mm beyond it",
          now_.driven_rad * kDegrees, end.gap_mm);
      if (spent()) why = "it takes too many steps";
      return false;
    }
  }
  return true;
}

Trajectory follow(const FoldModel& file, const Sheet& sheet, const RigidSheet& rigid,
                  const std::vector<LineHint>& hints, std::size_t driver,
                  std::span<const double> psi_rad, double slack_mm) {
  Trajectory opening;
  const HingeLine& line = rigid.lines[driver];
  opening.driver_edge = sheet.hinges[line.hinge].edge;
  opening.driver_length_mm = norm(line.to - line.from);
  opening.reached_psi_rad = kPi;
  RigidSolver solver(rigid);
  Follower follower(rigid, hints, solver, driver, slack_mm);
  if (follower.leave(!file.fold_angle_deg.empty(), opening.guess, opening.stopped)) {
    for (const double psi : psi_rad) {
      if (!follower.reach(kPi - psi, opening.stopped)) break;
      opening.gap_mm = std::max(opening.gap_mm, follower.gap_mm());
      opening.poses.push_back(pose_of(file, sheet, follower.now().state, psi, "opened"));
    }
    opening.reached_psi_rad = kPi - follower.now().driven_rad;
    // If it stops early, the last pose still shows what the sheet does.
    if (!opening.stopped.empty() &&
        (opening.poses.empty() || *opening.poses.back().psi_rad - opening.reached_psi_rad > 0.01)) {
      opening.gap_mm = std::max(opening.gap_mm, follower.gap_mm());
      opening.poses.push_back(
          pose_of(file, sheet, follower.now().state, opening.reached_psi_rad, "opened"));
    }
    opening.reversed = follower.reversed();
    if (follower.unfolded() > 0)
      opening.notes.push_back(
          fmt::format("{} folds stay flat in this motion", follower.unfolded()));
  }
  opening.steps = follower.steps();
  opening.iterations = solver.iterations();
  opening.spent = follower.spent();
  return opening;
}

}  // namespace

Trajectory open_sheet(const FoldModel& file, const Sheet& sheet, std::span<const double> psi_rad,
                      double slack_mm) {
  Trajectory best;
  best.reached_psi_rad = kPi;
  const std::vector<HingeLine> lines = hinge_lines(file, sheet);
  if (lines.empty()) {
    best.stopped = "the sheet does not open: no two rigid faces have a fold between them";
    return best;
  }
  bool first = true;
  for (const std::size_t driver : drivers_of(file, sheet, lines)) {
    const RigidSheet rigid =
        rigid_sheet(file, sheet, std::min(lines[driver].left, lines[driver].right));
    const std::vector<LineHint> hints = hints_of(file, sheet, rigid);
    Trajectory opening = follow(file, sheet, rigid, hints, driver, psi_rad, slack_mm);
    const bool spent = opening.spent;
    const bool farther = opening.reached_psi_rad < best.reached_psi_rad;
    if (first || farther) best = std::move(opening);
    first = false;
    if (best.stopped.empty() || spent) break;
  }
  return best;
}

std::optional<std::uint32_t> driving_hinge(const FoldModel& file, const Sheet& sheet) {
  const std::vector<HingeLine> lines = hinge_lines(file, sheet);
  if (lines.empty()) return {};
  return lines[drivers_of(file, sheet, lines).front()].hinge;
}

}  // namespace popcut::verify
