// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "core/design/lattice/band_cholesky.hpp"
#include "core/design/lattice/lattice.hpp"

namespace popcut {
namespace {

constexpr double kEndWeight = 1e4;
constexpr double kStuck = 0.1;  ///< of what settles a stage: what a step gains that limits hold up
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A step of a connector cell: plane `plus` minus plane `minus`, either an unknown (index) or a
/// constant zero (-1).
struct Step {
  int plus{-1}, minus{-1};
};

/// The minimisation of docs/geometry.md, section 4, over the planes of one run. The unknowns are
/// ordered slice by slice; all terms are built from connector steps, connector vertices and ends.
class Conformal {
 public:
  Conformal(const RunTarget& target, Planes start)
      : target_(target), planes_(std::move(start)), n_(target.units), mean_(target.mean_step()) {
    most_ = target.max_step_over_mean ? *target.max_step_over_mean * mean_ : kInfinity;
    index_.assign(planes_.value.size(), -1);
    for (int j = 0; j < target.slices(); ++j)
      for (int i = 0; i <= n_; ++i)
        if (!constant(j, i)) {
          index_[target.at(j, i)] = static_cast<int>(unknown_.size());
          unknown_.push_back(planes_.at(j, i));
        }
    gradient_.resize(unknown_.size());
    matrix_.emplace(static_cast<int>(unknown_.size()), band());
  }

  ConformalEffort run(std::optional<double> give_up_over_mean, const Progress& progress) {
    ConformalEffort effort{0, static_cast<int>(unknown_.size())};
    constexpr int kLastStage = 20;
    constexpr double kStageSettled = 1e-3;  // of the function: near enough for the next stage
    constexpr int kExactStage = 6;  // from mu = 1e3 on the vertices are nearly on the target
    double weight = 0.01 * mean_ * mean_;
    for (int stage = 0; stage <= kLastStage; ++stage, weight *= 0.5) {
      const double mu = std::pow(10.0, 0.5 * stage);
      tell(progress, "laying the lattice: conformal",
           static_cast<double>(stage) / static_cast<double>(kLastStage + 1));
      for (int step = 0; step < 30; ++step) {
        ++effort.steps;
        if (!newton(mu, weight, stage == kLastStage ? 0.0 : kStageSettled)) break;
      }
      if (give_up_over_mean && stage >= kExactStage && longest_step() > *give_up_over_mean * mean_)
        break;
    }
    return effort;
  }

  [[nodiscard]] Planes planes() const {
    Planes out = planes_;
    for (std::size_t k = 0; k < index_.size(); ++k)
      if (index_[k] >= 0) out.value[k] = unknown_[static_cast<std::size_t>(index_[k])];
    return out;
  }

 private:
  /// X_0 = 0 and Z_N = 0 are the wall and the ground.
  [[nodiscard]] bool constant(int j, int i) const {
    return (i == 0 && !Planes::holds_height(j, i)) || (i == n_ && Planes::holds_height(j, i));
  }
  [[nodiscard]] int x_index(int k, int i) const {
    return index_[target_.at(Planes::holds_height(k, i) ? k + 1 : k, i)];
  }
  [[nodiscard]] int z_index(int k, int i) const {
    return index_[target_.at(Planes::holds_height(k, i) ? k : k + 1, i)];
  }
  [[nodiscard]] static double value(const std::vector<double>& a, int index) {
    return index < 0 ? 0.0 : a[static_cast<std::size_t>(index)];
  }
  /// lx of cell i (1..N) of connector k, and lz.
  [[nodiscard]] Step step_x(int k, int i) const { return {x_index(k, i), x_index(k, i - 1)}; }
  [[nodiscard]] Step step_z(int k, int i) const { return {z_index(k, i - 1), z_index(k, i)}; }

  /// How far apart coupled unknowns are: within a connector, planes of levels at most two apart on
  /// each axis (the bends), and both planes of each vertex.
  [[nodiscard]] int band() const {
    int most = 1;
    const auto couple = [&](int a, int b) {
      if (a >= 0 && b >= 0) most = std::max(most, std::abs(a - b));
    };
    for (int k = 0; k + 1 < target_.slices(); ++k)
      for (int i = 0; i <= n_; ++i) {
        couple(x_index(k, i), z_index(k, i));
        for (int other = std::max(0, i - 2); other < i; ++other) {
          couple(x_index(k, i), x_index(k, other));
          couple(z_index(k, i), z_index(k, other));
        }
      }
    return most;
  }

  void add(int a, int b, double amount) {
    if (a >= 0 && b >= 0) matrix_->add(a, b, amount);
  }
  void push(int a, double amount) {
    if (a >= 0) gradient_[static_cast<std::size_t>(a)] += amount;
  }

  /// weight * (sum_k coefficient_k p_k - aim)^2 over up to three planes.
  template <std::size_t Count>
  void add_square(const int (&planes)[Count], const double (&coefficients)[Count], double aim,
                  double weight) {
    double residual = -aim;
    for (std::size_t a = 0; a < Count; ++a)
      residual += coefficients[a] * value(unknown_, planes[a]);
    for (std::size_t a = 0; a < Count; ++a) {
      push(planes[a], 2.0 * weight * coefficients[a] * residual);
      for (std::size_t b = 0; b <= a; ++b)
        add(planes[a], planes[b], 2.0 * weight * coefficients[a] * coefficients[b]);
    }
  }

  /// Barriers of one step, -w log(l - min) and -w log(most - l).
  void add_barrier(Step s, double weight) {
    const double l = value(unknown_, s.plus) - value(unknown_, s.minus);
    const double low = 1.0 / (l - target_.min_panel_mm);
    const double high = most_ < kInfinity ? 1.0 / (most_ - l) : 0.0;
    const double slope = weight * (high - low), bend = weight * (low * low + high * high);
    push(s.plus, slope);
    push(s.minus, -slope);
    add(s.plus, s.plus, bend);
    add(s.minus, s.minus, bend);
    add(s.plus, s.minus, -bend);
  }

  void assemble(double mu, double weight) {
    std::fill(gradient_.begin(), gradient_.end(), 0.0);
    matrix_->set_zero();
    for (int k = 0; k + 1 < target_.slices(); ++k) {
      const SliceCurve& curve = target_.connector_curves[static_cast<std::size_t>(k)];
      for (int i = 1; i <= n_; ++i) {
        const Step x = step_x(k, i), z = step_z(k, i);
        add_barrier(x, weight);
        add_barrier(z, weight);
        add_square({x.plus, x.minus}, {1.0, -1.0}, curve.d() / n_, 1.0);
        add_square({z.plus, z.minus}, {1.0, -1.0}, curve.h() / n_, 1.0);
        if (i == n_) continue;
        add_square({x_index(k, i + 1), x_index(k, i), x_index(k, i - 1)}, {1.0, -2.0, 1.0}, 0.0,
                   1.0);
        add_square({z_index(k, i + 1), z_index(k, i), z_index(k, i - 1)}, {1.0, -2.0, 1.0}, 0.0,
                   1.0);
        const int ix = x_index(k, i), iz = z_index(k, i);
        const CurveDistance e = curve.distance({value(unknown_, ix), value(unknown_, iz)});
        push(ix, 2.0 * mu * e.e * e.de_dx);
        push(iz, 2.0 * mu * e.e * e.de_dz);
        add(ix, ix, 2.0 * mu * e.de_dx * e.de_dx);
        add(iz, iz, 2.0 * mu * e.de_dz * e.de_dz);
        add(ix, iz, 2.0 * mu * e.de_dx * e.de_dz);
      }
    }
    for (int j = 0; j < target_.slices(); ++j) {
      const SliceCurve& curve = target_.slice_curves[static_cast<std::size_t>(j)];
      const int top = Planes::holds_height(j, 0) ? index_[target_.at(j, 0)] : -1;
      const int out = Planes::holds_height(j, n_) ? -1 : index_[target_.at(j, n_)];
      if (top >= 0) add_square({top}, {1.0}, curve.h(), kEndWeight);
      if (out >= 0) add_square({out}, {1.0}, curve.d(), kEndWeight);
    }
  }

  /// The function at `p`; infinite where a step leaves its limits.
  [[nodiscard]] double evaluate(const std::vector<double>& p, double mu, double weight) const {
    double sum = 0.0, logs = 0.0;
    const double min = target_.min_panel_mm;
    for (int k = 0; k + 1 < target_.slices(); ++k) {
      const SliceCurve& curve = target_.connector_curves[static_cast<std::size_t>(k)];
      double last_x = 0.0, last_z = 0.0;
      for (int i = 1; i <= n_; ++i) {
        const Step sx = step_x(k, i), sz = step_z(k, i);
        const double x = value(p, sx.plus) - value(p, sx.minus);
        const double z = value(p, sz.plus) - value(p, sz.minus);
        if (!(x > min) || !(z > min) || !(x < most_) || !(z < most_)) return kInfinity;
        logs += std::log((x - min) * (z - min));
        if (most_ < kInfinity) logs += std::log((most_ - x) * (most_ - z));
        const double off_x = x - curve.d() / n_, off_z = z - curve.h() / n_;
        sum += off_x * off_x + off_z * off_z;
        if (i > 1) sum += (x - last_x) * (x - last_x) + (z - last_z) * (z - last_z);
        last_x = x, last_z = z;
        if (i == n_) continue;
        const double e = curve.distance({value(p, sx.plus), value(p, sz.minus)}).e;
        sum += mu * e * e;
      }
    }
    for (int j = 0; j < target_.slices(); ++j) {
      const SliceCurve& curve = target_.slice_curves[static_cast<std::size_t>(j)];
      if (Planes::holds_height(j, 0)) {
        const double off = value(p, index_[target_.at(j, 0)]) - curve.h();
        sum += kEndWeight * off * off;
      }
      if (!Planes::holds_height(j, n_)) {
        const double off = value(p, index_[target_.at(j, n_)]) - curve.d();
        sum += kEndWeight * off * off;
      }
    }
    return sum - weight * logs;
  }

  [[nodiscard]] double longest_step() const {
    double most = 0.0;
    for (int k = 0; k + 1 < target_.slices(); ++k)
      for (int i = 1; i <= n_; ++i)
        for (const Step s : {step_x(k, i), step_z(k, i)})
          most = std::max(most, value(unknown_, s.plus) - value(unknown_, s.minus));
    return most;
  }

  /// The largest share of `move` that uses up at most 0.99 of any step's distance from its limits.
  [[nodiscard]] double longest(const std::vector<double>& move) const {
    double share = 1.0;
    const auto limit = [&](Step s) {
      const double l = value(unknown_, s.plus) - value(unknown_, s.minus);
      const double dl = value(move, s.plus) - value(move, s.minus);
      if (dl < 0.0) share = std::min(share, 0.99 * (l - target_.min_panel_mm) / -dl);
      if (dl > 0.0 && most_ < kInfinity) share = std::min(share, 0.99 * (most_ - l) / dl);
    };
    for (int k = 0; k + 1 < target_.slices(); ++k)
      for (int i = 1; i <= n_; ++i) limit(step_x(k, i)), limit(step_z(k, i));
    return share;
  }

  /// One damped step; false when the stage has ended.
  bool newton(double mu, double weight, double settled) {
    assemble(mu, weight);
    if (!matrix_->factorize()) return false;
    move_.resize(unknown_.size());
    for (std::size_t i = 0; i < move_.size(); ++i) move_[i] = -gradient_[i];
    matrix_->solve(move_);
    double decrease = 0.0;
    for (std::size_t i = 0; i < move_.size(); ++i) decrease -= 0.5 * gradient_[i] * move_[i];
    const double now = evaluate(unknown_, mu, weight);
    if (!(decrease > 1e-12 * weight) || decrease < settled * std::abs(now)) return false;
    double share = longest(move_);
    std::vector<double> trial(unknown_.size());
    for (; share > 1e-12; share *= 0.5) {
      for (std::size_t i = 0; i < trial.size(); ++i) trial[i] = unknown_[i] + share * move_[i];
      const double next = evaluate(trial, mu, weight);
      if (next <= now - 1e-4 * share * 2.0 * decrease) {
        unknown_.swap(trial);
        return now - next >= kStuck * settled * std::abs(now);
      }
    }
    return false;
  }

  const RunTarget& target_;
  Planes planes_;
  int n_;
  double mean_, most_{};
  std::vector<int> index_;  ///< unknown of each slice and level, -1 for wall and ground
  std::vector<double> unknown_;
  std::optional<BandCholesky> matrix_;
  std::vector<double> gradient_, move_;
};

/// Whether every connector step lies strictly between the limits.
bool strictly_feasible(const RunTarget& target, const Planes& planes) {
  const double most =
      target.max_step_over_mean ? *target.max_step_over_mean * target.mean_step() : kInfinity;
  for (int k = 0; k + 1 < target.slices(); ++k)
    for (int i = 1; i <= target.units; ++i) {
      const SectionPoint a = planes.vertex(k, i - 1), b = planes.vertex(k, i);
      for (const double l : {b.x - a.x, a.z - b.z})
        if (!(l > target.min_panel_mm) || !(l < most)) return false;
    }
  return true;
}

/// Equal steps of one mean d and h for all slices: feasible whenever anything is.
Planes equal_steps(const RunTarget& target) {
  double d = 0.0, h = 0.0;
  for (const SliceCurve& c : target.slice_curves) d += c.d(), h += c.h();
  d /= target.slices(), h /= target.slices();
  Planes planes{target.units, std::vector<double>(target.chain_x.size())};
  for (int j = 0; j < target.slices(); ++j)
    for (int i = 0; i <= target.units; ++i) {
      const double share = static_cast<double>(i) / target.units;
      planes.at(j, i) = Planes::holds_height(j, i) ? h * (1.0 - share) : d * share;
    }
  return planes;
}

}  // namespace

Result<Planes> lattice_conformal(const RunTarget& target, std::optional<double> give_up_over_mean,
                                 ConformalEffort* effort, const Progress& progress) {
  Planes start = lattice_slices(target);
  if (target.slices() < 2) return start;
  if (!strictly_feasible(target, start)) start = equal_steps(target);
  if (!strictly_feasible(target, start))
    return fail(
        ErrorKind::Infeasible, "",
        fmt::format("{} units of at least {:g} mm do not fit a mean step of {:.4g} mm; use fewer "
                    "units, a larger scale or a smaller min_panel_mm",
                    target.units, target.min_panel_mm, target.mean_step()));
  Conformal problem(target, std::move(start));
  const ConformalEffort spent = problem.run(give_up_over_mean, progress);
  if (effort != nullptr) *effort = spent;
  return problem.planes();
}

}  // namespace popcut
