// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <vector>

#include "core/design/spec/report.hpp"
#include "core/design/target/curve.hpp"
#include "core/result.hpp"

namespace popcut {

/// L of docs/geometry.md, section 3 (S2.A): squares of the differences of neighbouring steps plus
/// squares of the steps' distance from the even ones, over `x.size() - 1` units from (0, h) to (d,
/// 0).
[[nodiscard]] double chain_loss(std::span<const double> x, std::span<const double> z);

/// Places the fold vertices of one slice: `units + 1` points on `curve`, the ends at wall and
/// ground, that minimise `chain_loss`. Reusable: it keeps its arrays between slices.
///
/// Every vertex lies on the curve, so one parameter a vertex is unknown. The loss is quadratic in
/// the points and couples next but one neighbours, so the Hessian has two bands and a Newton step
/// costs O(units). Start: equal arcs; a curve that turns both ways may have several minima and is
/// solved from `kChainStarts` more places (even chords and fixed perturbations), the best kept.
/// Where the Hessian is not positive definite (curves with inflections) it is shifted, and each
/// step is halved until the loss falls.
inline constexpr int kChainStarts = 24;

class ChainSolver {
 public:
  /// Writes the points to `x` and `z` (`units + 1` each, both mm).
  ///
  /// @retval Infeasible  no minimum was found in 200 steps
  [[nodiscard]] Result<ChainFigures> solve(const SliceCurve& curve, int units, std::span<double> x,
                                           std::span<double> z);

 private:
  struct Minimum {
    double loss{};
    int iterations{};
    bool found{};
  };
  /// Newton from `t_` down to a minimum, left in `t_` and `jet_`.
  Minimum descend(const SliceCurve& curve);
  double load(const SliceCurve& curve, std::span<const double> t, bool with_derivatives);
  bool newton_step(double shift);

  std::vector<double> t_, trial_, step_, best_;
  std::vector<CurveJet> jet_;
  std::vector<double> gradient_, diagonal_, band1_, band2_, lower1_, lower2_;
};

/// Seconds that all slices together may take with SLSQP; each takes its share away.
struct SlsqpBudget {
  double total_s{600.0};
  double left_s{total_s};
};

/// The same minimum by NLopt's SLSQP on the full problem, as the paper's code uses an SQP: 2 N
/// steps unknown, N - 1 equations that each vertex lies on the curve, 2 that the steps sum to d and
/// h. The reference method (`"solver": "slsqp"`); its cost grows with the cube of the units.
///
/// @param budget    gives up when it is used up; what this slice took is taken from it
/// @retval Infeasible  NLopt failed, or its answer misses the curve by more than 1e-6 of the size
/// @retval Timeout     the budget is used up
[[nodiscard]] Result<ChainFigures> solve_chain_slsqp(const SliceCurve& curve, int units,
                                                     std::span<double> x, std::span<double> z,
                                                     SlsqpBudget& budget);

}  // namespace popcut
