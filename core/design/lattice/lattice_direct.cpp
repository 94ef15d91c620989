// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/design/lattice/band_cholesky.hpp"
#include "core/design/lattice/lattice.hpp"
#include "core/design/lattice/panel_error.hpp"

namespace popcut {
namespace {

/// The matrix of a direct lattice may take this much, bytes.
constexpr double kMostMatrix = 2e9;
/// Steps are that much longer than asked for: one that the solver leaves short by a hair would be
/// left out, with all that hangs on it.
constexpr double kSpare = 2e-3;
constexpr int kFirstSteps = 10, kMoreSteps = 8, kMostSteps = 40;             ///< of Newton
constexpr double kAllSteps = 3 * kFirstSteps + 2 * kMoreSteps + kMostSteps;  ///< at most, usually

/// What has a least value: a step, which is plane `a` less plane `b`, or with `sign` -1 a corner's
/// X + Z with its sign changed.
struct Bound {
  PlaneRef a, b;
  double sign_a{1.0}, sign_b{-1.0};
  double least{};

  [[nodiscard]] double spare(const std::vector<double>& p) const {
    return sign_a * a.of(p) + sign_b * b.of(p) - least;
  }
};

/// The levels that each connector uses, from the one on the wall to the one on the ground, as
/// planes that are zero say it (`Planes`).
struct LevelRange {
  int first{}, last{};
};

/// Which planes of a run are unknown, its panels and its bounds, for given endings of its levels.
class DirectModel {
 public:
  DirectModel(const RunTarget& target, const Planes& begin, double least)
      : target_(target), n_(target.units), least_(least) {
    for (int k = 0; k + 1 < target.slices(); ++k) ranges_.push_back(connector_range(begin, k));
    for (int j = 0; j < target.slices(); ++j) slice_ranges_.push_back(slice_range(begin, j));
    number(begin);
    for (int j = 0; j < target.slices(); ++j) {
      add_slice(j);
      if (j + 1 < target.slices()) add_connector(j);
    }
    for (const Panel& panel : panels) {
      couple(panel.begin.index, panel.end.index);
      couple(panel.begin.index, panel.plane.index);
      couple(panel.end.index, panel.plane.index);
    }
    for (const Bound& bound : bounds) couple(bound.a.index, bound.b.index);
  }

  /// Planes with the unknowns put in.
  [[nodiscard]] Planes planes(const Planes& begin, const std::vector<double>& p) const {
    Planes out = begin;
    for (std::size_t k = 0; k < index_.size(); ++k)
      if (index_[k] >= 0) out.value[k] = p[static_cast<std::size_t>(index_[k])];
    return out;
  }

  /// Largest X + Z of a corner.
  [[nodiscard]] double shut_reach_mm(const std::vector<double>& p) const {
    double most = 0.0;
    for (const Bound& corner : corners_) most = std::max(most, corner.spare(p));
    return most;
  }

  std::vector<double> start;  ///< of the unknowns
  std::vector<Panel> panels;
  std::vector<Bound> bounds;
  int band{1};

 private:
  [[nodiscard]] LevelRange connector_range(const Planes& planes, int k) const {
    LevelRange range{0, n_};
    for (int i = 0; i <= n_; ++i)
      if (planes.vertex(k, i).x == 0.0) range.first = i;
    for (int i = n_; i > range.first; --i)
      if (planes.vertex(k, i).z == 0.0) range.last = i;
    return range;
  }
  [[nodiscard]] LevelRange slice_range(const Planes& planes, int j) const {
    LevelRange range{0, n_};
    for (int i = 0; i <= n_; ++i)
      if (!Planes::holds_height(j, i) && planes.at(j, i) == 0.0) range.first = i + 1;
    for (int i = n_; i >= range.first; --i)
      if (Planes::holds_height(j, i) && planes.at(j, i) == 0.0) range.last = i - 1;
    return range;
  }
  /// The order of the unknowns: by slice and level, or where there are fewer slices than levels by
  /// level and slice, so that the band is narrow.
  void number(const Planes& planes) {
    index_.assign(planes.value.size(), -1);
    constants_ = planes.value;
    std::vector<std::uint8_t> used(planes.value.size(), 0);
    for (int j = 0; j < target_.slices(); ++j) {
      const LevelRange own = slice_ranges_[static_cast<std::size_t>(j)];
      for (int i = own.first; i <= own.last; ++i) used[target_.at(j, i)] = 1;
    }
    const auto take = [&](int j, int i) {
      const std::size_t at = target_.at(j, i);
      if (used[at] == 0 || planes.value[at] == 0.0) return;
      index_[at] = static_cast<int>(start.size());
      start.push_back(planes.value[at]);
    };
    if (2 * target_.slices() < n_) {
      for (int i = 0; i <= n_; ++i)
        for (int j = 0; j < target_.slices(); ++j) take(j, i);
    } else {
      for (int j = 0; j < target_.slices(); ++j)
        for (int i = 0; i <= n_; ++i) take(j, i);
    }
  }
  [[nodiscard]] PlaneRef plane(int j, int i) const {
    const std::size_t at = target_.at(j, i);
    return {index_[at], index_[at] < 0 ? constants_[at] : 0.0};
  }
  [[nodiscard]] PlaneRef x(int k, int i) const {
    return plane(Planes::holds_height(k, i) ? k + 1 : k, i);
  }
  [[nodiscard]] PlaneRef z(int k, int i) const {
    return plane(Planes::holds_height(k, i) ? k : k + 1, i);
  }
  void couple(int a, int b) {
    if (a >= 0 && b >= 0) band = std::max(band, std::abs(a - b));
  }

  void add_step(PlaneRef plus, PlaneRef minus) {
    bounds.push_back({plus, minus, 1.0, -1.0, least_});
  }
  /// The corner where a level panel at the height `z` ends at the offset `x`.
  void add_corner(PlaneRef x, PlaneRef z) {
    corners_.push_back({x, z, 1.0, 1.0, 0.0});
    if (target_.shut_reach_mm && (x.index >= 0 || z.index >= 0))
      bounds.push_back({x, z, -1.0, -1.0, -*target_.shut_reach_mm});
  }

  /// Wall and ground where the target has them and the strip is lower or shorter.
  void add_ends(int strip, const SliceCurve& curve, PlaneRef top, PlaneRef out) {
    panels.push_back({top, {-1, curve.h()}, {-1, 0.0}, strip, false});
    panels.push_back({out, {-1, curve.d()}, {-1, 0.0}, strip, true});
  }

  void add_slice(int j) {
    const LevelRange own = slice_ranges_[static_cast<std::size_t>(j)];
    const SliceCurve& curve = target_.slice_curves[static_cast<std::size_t>(j)];
    const int strip = 2 * j;
    const PlaneRef zero{-1, 0.0};
    int first = own.first, last = own.last;
    if (!Planes::holds_height(j, first)) ++first;
    if (Planes::holds_height(j, last)) --last;
    if (first >= last) {
      add_ends(strip, curve, zero, zero);
      return;
    }
    for (int i = first; i <= last; ++i) {
      const bool level = Planes::holds_height(j, i);
      const PlaneRef before = i > first ? plane(j, i - 1) : zero;
      const PlaneRef after = i < last ? plane(j, i + 1) : zero;
      // Along a height x grows with the level, along an offset z falls.
      panels.push_back({level ? before : after, level ? after : before, plane(j, i), strip, level});
      if (!covered(j, i - 1, i + 1)) add_step(level ? after : before, level ? before : after);
      if (level && i < last && !covered(j, i, i + 1)) add_corner(after, plane(j, i));
    }
    add_ends(strip, curve, plane(j, first), plane(j, last));
  }
  /// Whether the steps of a connector of slice j lead from one level to another, and so keep them
  /// apart.
  [[nodiscard]] bool covered(int j, int from, int to) const {
    for (const int k : {j - 1, j}) {
      if (k < 0 || k + 1 >= target_.slices()) continue;
      const LevelRange range = ranges_[static_cast<std::size_t>(k)];
      if (range.first <= std::max(from, 0) && std::min(to, n_) <= range.last) return true;
    }
    return false;
  }

  void add_connector(int k) {
    const LevelRange range = ranges_[static_cast<std::size_t>(k)];
    const int strip = 2 * k + 1;
    for (int i = range.first; i < range.last; ++i) {
      panels.push_back({x(k, i), x(k, i + 1), z(k, i), strip, true});
      panels.push_back({z(k, i + 1), z(k, i), x(k, i + 1), strip, false});
      add_step(x(k, i + 1), x(k, i));
      add_step(z(k, i), z(k, i + 1));
      add_corner(x(k, i + 1), z(k, i));
    }
    add_ends(strip, target_.connector_curves[static_cast<std::size_t>(k)], z(k, range.first),
             x(k, range.last));
  }

  const RunTarget& target_;
  int n_;
  double least_;  ///< of steps
  std::vector<LevelRange> ranges_, slice_ranges_;
  std::vector<int> index_;
  std::vector<double> constants_;
  std::vector<Bound> corners_;  ///< their X + Z
};

/// Minimises the error over the unknowns within their bounds: a primal-dual interior
/// point method with slacks, so that it may start from steps that are too short (Nocedal and
/// Wright, Numerical Optimization, 2006, 19.3).
class DirectSolver {
 public:
  DirectSolver(const DirectModel& model, const PanelError& error, double mean)
      : model_(model), error_(error), mean_(mean), p_(model.start), gradient_(p_.size()) {
    error_now_ = value(p_);
    tau_ = 0.1 * error_now_ / static_cast<double>(std::max<std::size_t>(1, model_.bounds.size()));
    for (const Bound& bound : model_.bounds) {
      slack_.push_back(std::max(bound.spare(p_), 0.05 * mean_));
      force_.push_back(tau_ / slack_.back());
    }
  }

  /// Up to so many Newton steps more; none once there is nothing left to gain.
  void run(int rounds, DirectEffort& effort, const Progress& progress) {
    if (done_) return;
    BandCholesky matrix(static_cast<int>(p_.size()), model_.band);
    const auto count = static_cast<double>(std::max<std::size_t>(1, model_.bounds.size()));
    while (rounds-- > 0) {
      tell(progress, "laying the lattice: direct", std::min(1.0, effort.steps / kAllSteps));
      ++effort.steps;
      error_now_ = assemble(matrix);
      if (!matrix.factorize()) {
        shift_ = std::max(4.0 * shift_, 1e-3 * scale_);
        continue;
      }
      move_ = right_;
      matrix.solve(move_);
      const double share = line_search();
      if (share == 0.0) {
        if (shift_ > 1e6 * scale_) {
          done_ = true;
          return;
        }
        shift_ = std::max(8.0 * shift_, 1e-2 * scale_);
        continue;
      }
      if (share > 0.5) shift_ *= 0.25;
      if (shift_ < 1e-6 * scale_) shift_ = 0.0;
      const double before = error_now_;
      error_now_ = value(p_);
      double gap = 0.0;
      for (std::size_t c = 0; c < slack_.size(); ++c) gap += slack_[c] * force_[c];
      const bool settled = std::abs(error_now_ - before) < kSettled * before &&
                           gap < 10.0 * kSettled * error_now_ && shortfall() < 1e-6 * mean_;
      still_ = settled ? still_ + 1 : 0;
      if (still_ >= 2) {
        done_ = true;
        return;
      }
      const double aim = (share > 0.5 ? 0.2 : 0.7) * gap / count;
      tau_ = std::min(tau_, std::max(aim, 0.1 * kSettled * error_now_ / count));
    }
  }

  /// The error that was reached.
  [[nodiscard]] double error() const { return error_now_; }
  /// For comparison of attempts that are on their way: steps that are too short still have to be
  /// paid for.
  [[nodiscard]] double rank() const { return error_now_ * (1.0 + 5.0 * shortfall() / mean_); }
  [[nodiscard]] const std::vector<double>& unknowns() const { return p_; }
  /// Largest shortfall of a bound, mm.
  [[nodiscard]] double shortfall() const {
    double most = 0.0;
    for (const Bound& bound : model_.bounds) most = std::max(most, -bound.spare(p_));
    return most;
  }

 private:
  static constexpr double kSettled = 1e-4;

  [[nodiscard]] double value(const std::vector<double>& p) const {
    double sum = 0.0;
    for (const Panel& panel : model_.panels) sum += error_.value(panel, p);
    return sum;
  }

  /// Matrix and right side of a Newton step; the error.
  double assemble(BandCholesky& matrix) {
    matrix.set_zero();
    std::fill(gradient_.begin(), gradient_.end(), 0.0);
    double sum = 0.0, trace = 0.0;
    for (const Panel& panel : model_.panels) {
      const PanelError::Jet jet = error_.jet(panel, p_);
      sum += jet.value;
      const std::array at{panel.begin.index, panel.end.index, panel.plane.index};
      std::size_t entry = 0;
      for (std::size_t a = 0; a < 3; ++a) {
        if (at[a] >= 0) gradient_[static_cast<std::size_t>(at[a])] += jet.first[a];
        for (std::size_t b = a; b < 3; ++b, ++entry)
          if (at[a] >= 0 && at[b] >= 0) matrix.add(at[a], at[b], jet.second[entry]);
        if (at[a] >= 0 && a == 2) trace += jet.second[5];
      }
    }
    scale_ = trace / static_cast<double>(p_.size());
    right_.resize(p_.size());
    for (std::size_t k = 0; k < p_.size(); ++k) right_[k] = -gradient_[k];
    for (std::size_t c = 0; c < slack_.size(); ++c) {
      const Bound& bound = model_.bounds[c];
      const double off = bound.spare(p_) - slack_[c];
      const double stiff = force_[c] / slack_[c];
      const double push = tau_ / slack_[c] - stiff * off;
      const int a = bound.a.index, b = bound.b.index;
      if (a >= 0)
        right_[static_cast<std::size_t>(a)] += bound.sign_a * push, matrix.add(a, a, stiff);
      if (b >= 0)
        right_[static_cast<std::size_t>(b)] += bound.sign_b * push, matrix.add(b, b, stiff);
      if (a >= 0 && b >= 0) matrix.add(a, b, bound.sign_a * bound.sign_b * stiff);
    }
    if (shift_ > 0.0)
      for (int k = 0; k < static_cast<int>(p_.size()); ++k) matrix.add(k, k, shift_);
    return sum;
  }

  [[nodiscard]] double change(const Bound& bound) const {
    const auto of = [&](int index) {
      return index < 0 ? 0.0 : move_[static_cast<std::size_t>(index)];
    };
    return bound.sign_a * of(bound.a.index) + bound.sign_b * of(bound.b.index);
  }

  /// Goes along `move_` as far as the merit falls; the share of it that was gone.
  double line_search() {
    const std::size_t count = slack_.size();
    slack_move_.resize(count), force_move_.resize(count);
    double primal = 1.0, dual = 1.0, infeasible = 0.0, logs = 0.0, slope = 0.0;
    for (std::size_t k = 0; k < p_.size(); ++k) slope += gradient_[k] * move_[k];
    for (std::size_t c = 0; c < count; ++c) {
      const Bound& bound = model_.bounds[c];
      const double off = bound.spare(p_) - slack_[c];
      const double ds = slack_move_[c] = change(bound) + off;
      const double df = force_move_[c] = (tau_ - force_[c] * ds) / slack_[c] - force_[c];
      if (ds < 0.0) primal = std::min(primal, -0.995 * slack_[c] / ds);
      if (df < 0.0) dual = std::min(dual, -0.995 * force_[c] / df);
      infeasible += std::abs(off);
      logs += std::log(slack_[c]);
      slope -= tau_ * ds / slack_[c];
    }
    if (infeasible > 1e-12 * mean_) price_ = std::max(price_, 2.0 * slope / infeasible);
    slope -= price_ * infeasible;
    const double merit = error_now_ - tau_ * logs + price_ * infeasible;
    std::vector<double>& trial = trial_;
    trial.resize(p_.size());
    for (double share = primal; share > 1e-6; share *= 0.5) {
      for (std::size_t k = 0; k < p_.size(); ++k) trial[k] = p_[k] + share * move_[k];
      double off = 0.0, trial_logs = 0.0;
      for (std::size_t c = 0; c < count; ++c) {
        const double slack = slack_[c] + share * slack_move_[c];
        off += std::abs(model_.bounds[c].spare(trial) - slack);
        trial_logs += std::log(slack);
      }
      const double next = value(trial) - tau_ * trial_logs + price_ * off;
      if (!(next <= merit + 1e-4 * share * std::min(slope, 0.0) + 1e-12 * std::abs(merit)))
        continue;
      p_.swap(trial);
      for (std::size_t c = 0; c < count; ++c) {
        slack_[c] += share * slack_move_[c];
        force_[c] = std::clamp(force_[c] + dual * force_move_[c], 1e-8 * tau_ / slack_[c],
                               1e8 * tau_ / slack_[c]);
      }
      return share;
    }
    return 0.0;
  }

  const DirectModel& model_;
  const PanelError& error_;
  double mean_;
  std::vector<double> p_;
  std::vector<double> gradient_, right_, move_, trial_;
  std::vector<double> slack_, force_, slack_move_, force_move_;
  double error_now_{}, tau_{}, shift_{}, scale_{}, price_{};
  int still_{};
  bool done_{false};
};

/// The best planes from all starts.
struct BestPlanes {
  Planes planes;
  double shortfall_mm{}, shut_reach_mm{};
};

/// Which levels end where is not to be had from derivatives: starts with different endings, each
/// for some steps, the better ones for some more, and the best to its end.
BestPlanes best_planes(const RunTarget& target, const PanelError& error, DirectEffort& spent,
                       const Progress& progress) {
  const double mean = target.mean_step();
  const std::vector<Planes> starts{lattice_slices(target), lattice_levels(target, 1.25),
                                   lattice_levels(target, 2.0)};
  std::vector<std::unique_ptr<DirectModel>> models;
  std::vector<std::unique_ptr<DirectSolver>> solvers;
  std::vector<std::size_t> order;
  for (const Planes& start : starts) {
    order.push_back(solvers.size());
    models.push_back(
        std::make_unique<DirectModel>(target, start, (1.0 + kSpare) * target.min_panel_mm));
    solvers.push_back(std::make_unique<DirectSolver>(*models.back(), error, mean));
  }
  for (const int steps : {kFirstSteps, kMoreSteps, kMostSteps}) {
    for (const std::size_t k : order) solvers[k]->run(steps, spent, progress);
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return solvers[a]->rank() < solvers[b]->rank();
    });
    if (order.size() > 1) order.pop_back();
  }
  const std::size_t best = order.front();
  spent.unknowns = static_cast<int>(models[best]->start.size());
  const std::vector<double>& p = solvers[best]->unknowns();
  return {models[best]->planes(starts[best], p), solvers[best]->shortfall(),
          models[best]->shut_reach_mm(p)};
}

}  // namespace

Result<Planes> lattice_direct(const RunTarget& target, DirectEffort* effort,
                              const Progress& progress) {
  if (target.slices() < 2) return lattice_slices(target);
  const double bytes = BandCholesky::bytes(
      static_cast<double>(target.chain_x.size()),
      std::min(static_cast<double>(target.units) + 2.0, 2.0 * target.slices() + 1.0));
  if (bytes > kMostMatrix)
    return fail(ErrorKind::OutOfRange, "/lattice",
                fmt::format("a direct lattice of {} units and {} slices would take {:.1f} GB; use "
                            "\"slices\" or \"levels\"",
                            target.units, target.slices(), 1e-9 * bytes));
  const PanelError error(target);
  DirectEffort spent;
  RunTarget free = target;
  free.shut_reach_mm.reset();
  BestPlanes best = best_planes(free, error, spent, progress);
  if (target.shut_reach_mm && best.shut_reach_mm > *target.shut_reach_mm) {
    BestPlanes held = best_planes(target, error, spent, progress);
    if (held.shortfall_mm <= kSpare * target.min_panel_mm) best = std::move(held);
  }
  if (effort != nullptr) *effort = spent;
  return std::move(best.planes);
}

}  // namespace popcut
