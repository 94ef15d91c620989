// SPDX-License-Identifier: MIT
#include "core/design/chain/chain.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <fmt/format.h>

namespace popcut {
namespace {

double axis_loss(std::span<const double> p) {
  const std::size_t n = p.size() - 1;
  const double even = (p[n] - p[0]) / static_cast<double>(n);
  double sum = 0.0, last = 0.0;
  for (std::size_t i = 1; i <= n; ++i) {
    const double step = p[i] - p[i - 1];
    if (i > 1) sum += (step - last) * (step - last);
    sum += (step - even) * (step - even);
    last = step;
  }
  return sum;
}

}  // namespace

double chain_loss(std::span<const double> x, std::span<const double> z) {
  return axis_loss(x) + axis_loss(z);
}

/// Evaluates the curve at `t` and returns the loss; with derivatives also fills the gradient and
/// the bands of the Hessian by the parameters.
double ChainSolver::load(const SliceCurve& curve, std::span<const double> t,
                         bool with_derivatives) {
  const std::size_t n = t.size() - 1;
  for (std::size_t i = 1; i < n; ++i) jet_[i] = curve.at(t[i]);
  jet_[0] = CurveJet{0.0, curve.h(), 0, 0, 0, 0};
  jet_[n] = CurveJet{curve.d(), 0.0, 0, 0, 0, 0};

  const double even_x = curve.d() / static_cast<double>(n);
  const double even_z = -curve.h() / static_cast<double>(n);
  // Derivatives of L by step i are 2 (bend(i-1) - bend(i)) + 2 (step(i) - even), bend the
  // difference of neighbouring steps; those by point i are the differences of these.
  double loss = 0.0;
  double step_x = jet_[1].x - jet_[0].x, step_z = jet_[1].z - jet_[0].z;
  double bend_x = 0.0, bend_z = 0.0, last_x = 0.0, last_z = 0.0;
  for (std::size_t i = 1; i <= n; ++i) {
    const double next_x = i < n ? jet_[i + 1].x - jet_[i].x : step_x;
    const double next_z = i < n ? jet_[i + 1].z - jet_[i].z : step_z;
    const double ahead_x = next_x - step_x, ahead_z = next_z - step_z;
    const double off_x = step_x - even_x, off_z = step_z - even_z;
    loss += ahead_x * ahead_x + ahead_z * ahead_z + off_x * off_x + off_z * off_z;
    const double by_x = 2.0 * (bend_x - ahead_x + off_x), by_z = 2.0 * (bend_z - ahead_z + off_z);
    if (with_derivatives && i > 1) {
      const CurveJet& p = jet_[i - 1];
      const double gx = last_x - by_x, gz = last_z - by_z;
      gradient_[i - 1] = gx * p.dx + gz * p.dz;
      diagonal_[i - 1] = gx * p.ddx + gz * p.ddz;
    }
    last_x = by_x, last_z = by_z;
    bend_x = ahead_x, bend_z = ahead_z;
    step_x = next_x, step_z = next_z;
  }
  if (!with_derivatives) return loss;
  for (std::size_t i = 1; i < n; ++i) {
    const CurveJet& p = jet_[i];
    // Second derivatives by the points: 2 [1 -4 6 -4 1] of the bends and 2 [-1 2 -1] of the steps.
    const double own = 2.0 * (4.0 + (i >= 2 ? 1.0 : 0.0) + (i + 2 <= n ? 1.0 : 0.0) + 2.0);
    diagonal_[i] += own * (p.dx * p.dx + p.dz * p.dz);
    if (i + 1 < n) band1_[i] = -10.0 * (p.dx * jet_[i + 1].dx + p.dz * jet_[i + 1].dz);
    if (i + 2 < n) band2_[i] = 2.0 * (p.dx * jet_[i + 2].dx + p.dz * jet_[i + 2].dz);
  }
  return loss;
}

/// Solves (Hessian + shift) step = -gradient by a banded L D L^T; false where it is not positive.
bool ChainSolver::newton_step(double shift) {
  const std::size_t n = t_.size() - 1;
  // step_ holds the right side, then the answer; trial_ is scratch for the pivots.
  double l1_last = 0.0, d_last = 0.0, d_before = 0.0, l2_last = 0.0, l2_before = 0.0;
  double y_last = 0.0, y_before = 0.0;
  for (std::size_t i = 1; i < n; ++i) {
    const double l2 = l2_before;  // of rows i, i - 2
    const double d = diagonal_[i] + shift - l1_last * l1_last * d_last - l2 * l2 * d_before;
    if (!(d > 0.0)) return false;
    const double inverse = 1.0 / d;
    const double y = -gradient_[i] - l1_last * y_last - l2 * y_before;
    step_[i] = y * inverse;
    const double l1 = i + 1 < n ? (band1_[i] - l2_last * l1_last * d_last) * inverse : 0.0;
    const double l2_next = i + 2 < n ? band2_[i] * inverse : 0.0;
    lower1_[i] = l1;
    lower2_[i] = l2_next;
    y_before = y_last, y_last = y;
    d_before = d_last, d_last = d;
    l2_before = l2_last, l2_last = l2_next;
    l1_last = l1;
  }
  for (std::size_t i = n - 1; i-- > 1;) {
    step_[i] -= lower1_[i] * step_[i + 1];
    if (i + 2 < n) step_[i] -= lower2_[i] * step_[i + 2];
  }
  return true;
}

ChainSolver::Minimum ChainSolver::descend(const SliceCurve& curve) {
  const std::size_t n = t_.size() - 1;
  constexpr int kMostSteps = 200;
  // What rounding leaves of a step, relative to the parameter's range of 2.
  constexpr double kStepNoise = 1e-13;
  double loss = load(curve, t_, true);
  double shift = 0.0;
  int iterations = 0;
  bool done = n == 1;
  while (!done && iterations < kMostSteps) {
    ++iterations;
    const double scale = *std::max_element(diagonal_.begin() + 1,
                                           diagonal_.begin() + static_cast<std::ptrdiff_t>(n));
    for (int tries = 0; !newton_step(shift); ++tries) {
      shift = std::max(2.0 * shift, 1e-3 * std::abs(scale));
      // A curve that is not finite has no minimum.
      if (tries == 200 || !std::isfinite(shift)) return {loss, kMostSteps, false};
    }
    double largest = 0.0, slope = 0.0, share = 1.0;
    for (std::size_t i = 1; i < n; ++i) {
      largest = std::max(largest, std::abs(step_[i]));
      slope += gradient_[i] * step_[i];
    }
    if (largest < kStepNoise && shift == 0.0) break;
    // A step may close at most nine tenths of a gap between neighbours.
    for (std::size_t i = 1; i <= n; ++i) {
      const double closing = (i > 1 ? step_[i - 1] : 0.0) - (i < n ? step_[i] : 0.0);
      const double gap = t_[i] - t_[i - 1];
      if (closing * share > 0.9 * gap) share = 0.9 * gap / closing;
    }
    double next_loss = std::numeric_limits<double>::infinity();
    trial_[0] = -1.0, trial_[n] = 1.0;
    for (; share > 1e-12; share *= 0.5) {
      for (std::size_t i = 1; i < n; ++i) trial_[i] = t_[i] + share * step_[i];
      next_loss = load(curve, trial_, true);
      if (next_loss <= loss + 1e-4 * share * slope || -slope <= 1e-15 * loss) break;
    }
    if (!(next_loss <= loss * (1.0 + 1e-12))) {  // no way down: at the minimum up to rounding
      load(curve, t_, true);
      break;
    }
    std::swap(t_, trial_);
    loss = next_loss;
    // At a corner of the curve, or where the loss itself is rounded, halving leaves nothing of a
    // step: the minimum is here.
    if (share * largest < kStepNoise) break;
    done = share == 1.0 && shift == 0.0 && largest < 1e-8;  // quadratic: the next is below 1e-15
    shift = share == 1.0 ? (shift < 1e-9 * std::abs(scale) ? 0.0 : 0.1 * shift) : shift;
  }
  return {loss, iterations, iterations < kMostSteps};
}

namespace {

/// Start `k` of a curve with inflections: chords of equal extent, then steps that grow and shrink
/// by a wave whose length, phase and height vary with k in fixed ways.
void perturbed_start(const std::vector<double>& even, int k, std::vector<double>& t) {
  const std::size_t n = even.size() - 1;
  if (k == 0) {
    for (std::size_t i = 0; i <= n; ++i)
      t[i] = -1.0 + 2.0 * static_cast<double>(i) / static_cast<double>(n);
    return;
  }
  const auto fraction = [](double a) { return a - std::floor(a); };
  const double waves = 0.5 + 0.5 * static_cast<double>((k - 1) % 6);
  const double phase = 2.0 * std::numbers::pi * fraction(0.6180339887 * k);
  const double height = 0.3 + 0.6 * fraction(0.7548776662 * k);
  double sum = 0.0;
  std::vector<double> at(n + 1, 0.0);
  for (std::size_t i = 1; i <= n; ++i) {
    const double place = (static_cast<double>(i) - 0.5) / static_cast<double>(n);
    sum += (even[i] - even[i - 1]) *
           (1.0 + height * std::sin(2.0 * std::numbers::pi * waves * place + phase));
    at[i] = sum;
  }
  for (std::size_t i = 0; i <= n; ++i) t[i] = -1.0 + 2.0 * at[i] / sum;
}

}  // namespace

Result<ChainFigures> ChainSolver::solve(const SliceCurve& curve, int units, std::span<double> x,
                                        std::span<double> z) {
  const auto n = static_cast<std::size_t>(units);
  t_ = curve.equal_arcs(units);
  trial_.resize(n + 1), step_.assign(n + 1, 0.0);
  jet_.resize(n + 1), gradient_.resize(n + 1), diagonal_.assign(n + 1, 0.0);
  band1_.resize(n + 1), band2_.resize(n + 1), lower1_.resize(n + 1), lower2_.resize(n + 1);

  ChainFigures figures;
  const bool several = curve.has_inflections() && units >= 2;
  const std::vector<double> even = several ? t_ : std::vector<double>{};
  Minimum best = descend(curve);
  int iterations = best.iterations;
  if (several) {
    std::vector<double> losses;
    if (best.found) losses.push_back(best.loss), best_ = t_;
    for (int k = 0; k < kChainStarts; ++k) {
      perturbed_start(even, k, t_);
      const Minimum next = descend(curve);
      iterations += next.iterations;
      if (!next.found) continue;
      losses.push_back(next.loss);
      if (!best.found || next.loss < best.loss) best = next, best_ = t_;
    }
    std::sort(losses.begin(), losses.end());
    constexpr double kSame = 1e-6;
    for (std::size_t i = 1; i < losses.size(); ++i)
      figures.minima += losses[i] > losses[i - 1] * (1.0 + kSame);
    if (figures.minima > 1 && losses.front() > 0.0)
      figures.spread = losses.back() / losses.front() - 1.0;
    if (best.found) t_ = best_, load(curve, t_, false);
  }
  if (!best.found)
    return fail(ErrorKind::Infeasible, "",
                fmt::format("the chain of {} units found no minimum in 200 steps", units));
  for (std::size_t i = 0; i <= n; ++i) x[i] = jet_[i].x, z[i] = jet_[i].z;
  x[0] = 0.0, z[0] = curve.h(), x[n] = curve.d(), z[n] = 0.0;
  figures.loss = chain_loss(x, z), figures.iterations = iterations;
  return figures;
}

}  // namespace popcut
