// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

#include <fmt/format.h>
#include <nlopt.h>

#include "core/design/chain/chain.hpp"

namespace popcut {
namespace {

/// The full problem: unknowns lx_1 .. lx_N, lz_1 .. lz_N, divided by d and h.
struct FullProblem {
  const SliceCurve& curve;
  std::size_t units;
  int evaluations{0};

  /// L of section 3 over the steps; the scaled unknowns bring their factor into the gradient.
  double loss(const double* p, double* gradient) {
    ++evaluations;
    const std::array size{curve.d(), curve.h()};
    double sum = 0.0;
    if (gradient != nullptr) std::fill(gradient, gradient + 2 * units, 0.0);
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const double* l = p + axis * units;
      double* g = gradient != nullptr ? gradient + axis * units : nullptr;
      const double weight = size[axis] * size[axis];
      for (std::size_t i = 0; i < units; ++i) {
        const double off = l[i] - 1.0 / static_cast<double>(units);
        sum += weight * off * off;
        if (g != nullptr) g[i] += 2.0 * weight * off;
        if (i + 1 == units) continue;
        const double bend = l[i + 1] - l[i];
        sum += weight * bend * bend;
        if (g != nullptr) g[i] -= 2.0 * weight * bend, g[i + 1] += 2.0 * weight * bend;
      }
    }
    return sum;
  }

  /// N - 1 equations "vertex i is on the curve" (section 3, as x/d + z/h = n(x/d - z/h)), then the
  /// two sums.
  void constraints(double* result, const double* p, double* gradient) const {
    const std::size_t columns = 2 * units;
    if (gradient != nullptr) std::fill(gradient, gradient + (units + 1) * columns, 0.0);
    double x = 0.0, z = 1.0;  // over d and h
    for (std::size_t i = 0; i + 1 < units; ++i) {
      x += p[i];
      z -= p[units + i];
      const CurveJet c = curve.at(x - z);
      const double n = c.x / curve.d() + c.z / curve.h();
      const double dn = c.dx / curve.d() + c.dz / curve.h();
      result[i] = x + z - n;
      if (gradient == nullptr) continue;
      double* row = gradient + i * columns;
      for (std::size_t k = 0; k <= i; ++k) row[k] = 1.0 - dn, row[units + k] = -1.0 - dn;
    }
    for (std::size_t axis = 0; axis < 2; ++axis) {
      double sum = -1.0;
      for (std::size_t i = 0; i < units; ++i) sum += p[axis * units + i];
      result[units - 1 + axis] = sum;
      if (gradient != nullptr)
        std::fill_n(gradient + (units - 1 + axis) * columns + axis * units, units, 1.0);
    }
  }
};

double loss_of(unsigned, const double* p, double* gradient, void* data) {
  return static_cast<FullProblem*>(data)->loss(p, gradient);
}

void constraints_of(unsigned, double* result, unsigned, const double* p, double* gradient,
                    void* data) {
  static_cast<const FullProblem*>(data)->constraints(result, p, gradient);
}

}  // namespace

Result<ChainFigures> solve_chain_slsqp(const SliceCurve& curve, int units, std::span<double> x,
                                       std::span<double> z, SlsqpBudget& budget) {
  const auto n = static_cast<std::size_t>(units);
  FullProblem problem{curve, n};
  const std::vector<double> t = curve.equal_arcs(units);
  std::vector<double> p(2 * n);
  SectionPoint last{0.0, curve.h()};
  for (std::size_t i = 1; i <= n; ++i) {
    const CurveJet c = curve.at(t[i]);
    p[i - 1] = (c.x - last.x) / curve.d();
    p[n + i - 1] = (last.z - c.z) / curve.h();
    last = {c.x, c.z};
  }
  const auto unknowns = static_cast<unsigned>(2 * n);
  nlopt_opt opt = nlopt_create(NLOPT_LD_SLSQP, unknowns);
  const std::vector<double> tolerance(n + 1, 1e-12);
  nlopt_set_min_objective(opt, loss_of, &problem);
  nlopt_add_equality_mconstraint(opt, static_cast<unsigned>(n + 1), constraints_of, &problem,
                                 tolerance.data());
  nlopt_set_lower_bounds1(opt, 0.0);
  nlopt_set_ftol_rel(opt, 1e-14);
  nlopt_set_xtol_rel(opt, 1e-12);
  nlopt_set_maxtime(opt, std::max(budget.left_s, 1e-9));
  double best = 0.0;
  const auto start = std::chrono::steady_clock::now();  // as NLopt itself measures its time
  const nlopt_result end = nlopt_optimize(opt, p.data(), &best);
  budget.left_s -= std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  nlopt_destroy(opt);
  if (end == NLOPT_MAXTIME_REACHED)
    return fail(ErrorKind::Timeout, "",
                fmt::format("SLSQP is not done after {:.0f} s for all slices together; use the "
                            "newton solver, or fewer units or slices",
                            budget.total_s));

  x[0] = 0.0, z[0] = curve.h();
  for (std::size_t i = 1; i <= n; ++i) {
    x[i] = x[i - 1] + curve.d() * p[i - 1];
    z[i] = z[i - 1] - curve.h() * p[n + i - 1];
  }
  std::vector<double> miss(n + 1);
  problem.constraints(miss.data(), p.data(), nullptr);
  const double worst = std::abs(*std::max_element(
      miss.begin(), miss.end(), [](double a, double b) { return std::abs(a) < std::abs(b); }));
  // NLOPT_ROUNDOFF_LIMITED (-4) still leaves a useful answer; the curve decides.
  if ((end < 0 && end != NLOPT_ROUNDOFF_LIMITED) || !(worst < 1e-6))
    return fail(ErrorKind::Infeasible, "",
                fmt::format("SLSQP stopped with code {}, {:.2g} of the size off the curve; use the "
                            "newton solver",
                            static_cast<int>(end), worst));
  x[n] = curve.d(), z[n] = 0.0;  // the sums hold to 1e-12 only
  return ChainFigures{chain_loss(x, z), problem.evaluations};
}

}  // namespace popcut
