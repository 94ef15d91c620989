// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <vector>

#include "core/design/spec/spec.hpp"
#include "core/design/target/curve.hpp"
#include "core/result.hpp"

namespace popcut {

/// The slices that are solved together: a surface (i, j) -> P_i^j through their fold vertices.
struct SliceStack {
  std::span<const SliceCurve> curves;  ///< one a slice, 3 or more
  std::span<const double> v_mm;        ///< where each slice's middle lies along the spine, rising
  int units{};                         ///< N, 2 or more

  /// Vertices with all neighbours: levels 1 .. N - 1 of slices 1 .. M - 2.
  [[nodiscard]] std::size_t inner() const {
    return curves.size() < 3 || units < 2
               ? 0
               : (curves.size() - 2) * (static_cast<std::size_t>(units) - 1);
  }
};

struct AugmentedLoss {
  double chains{};     ///< sum of L_j over the slices, mm^2
  double curvature{};  ///< the added terms, weights and all, mm^2
  [[nodiscard]] double total() const { return chains + curvature; }
};

/// Points of all slices, slice by slice, N + 1 each.
struct StackPoints {
  std::vector<double> x, z;  ///< mm
};

struct AugmentedChains {
  StackPoints points;
  AugmentedLoss start;  ///< of the plain chains, each slice for itself
  AugmentedLoss loss;
  int evaluations{};
  bool out_of_time{};  ///< the budget was used up; the best so far is given
};

/// The target of one inner vertex: the `k`-th of a list, or what stands there for all; 0 for none.
template <typename T>
[[nodiscard]] T target_of(const std::vector<T>& list, std::size_t k) {
  if (list.empty()) return {};
  return list.size() == 1 ? list.front() : list[k];
}

/// The augmented loss of S4 at given points,
///
///     sum_j L_j + sum_(i, j) lambda_K (K - K~)^2 + lambda_H (H - H~)^2
///                          + lambda_a |a - a~|^2 + lambda_b |b - b~|^2,
///
/// over the inner vertices, K and H those of the ring (i+1,j) (i,j+1) (i-1,j) (i,j-1), a and b its
/// forms with the mixed difference of the diagonal neighbours, |.| the Frobenius norm. The paper
/// writes the added terms for the five-unit assembly; here every inner vertex is the middle of one.
///
/// Weights are without unit: with S the mean of (d + h) / 2 over the slices, the terms are S^2
/// times the squares of S^2 (K - K~), S (H - H~), (a - a~) / S^2, (b - b~) / S, so that a scaled
/// surface has the scaled solution, and S = 1 gives the paper's own formula.
///
/// @param first  index of this stack's first inner vertex in the lists of `spec`
/// @retval OutOfRange  sizes that do not agree, fewer than 3 slices or 2 units, v not rising, a
///                     weight that is negative or not finite, or one without its targets
[[nodiscard]] Result<AugmentedLoss> augmented_loss(const SliceStack& stack,
                                                   const StackPoints& points,
                                                   const AugmentedSpec& spec,
                                                   std::size_t first = 0);

/// Chains that minimise it, every vertex on its slice's curve and in order along it: NLopt's L-BFGS
/// on the logarithms of the vertices' spacings along the curves, exact slopes by forward
/// differentiation, from the plain chains. A local minimum; an evaluation costs O(slices x units).
///
/// @param budget_s  of the search, in seconds
/// @retval OutOfRange  as `augmented_loss`
/// @retval Infeasible  a plain chain has no minimum (as `ChainSolver`), or the loss is not finite
[[nodiscard]] Result<AugmentedChains> solve_chain_augmented(const SliceStack& stack,
                                                            const AugmentedSpec& spec,
                                                            std::size_t first = 0,
                                                            int most_evaluations = 2000,
                                                            double budget_s = 120.0);

}  // namespace popcut
