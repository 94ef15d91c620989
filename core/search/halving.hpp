// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace popcut {

/// What a candidate of a search got.
struct Judged {
  double error{};   ///< less is better
  double cost{};    ///< less is better
  bool made{true};  ///< false: nothing came of it
  bool stays{};     ///< it goes on whatever it got
};

/// One step of successive halving (Karnin, Koren and Somekh, Almost Optimal Exploration in
/// Multi-Armed Bandits, 2013; Jamieson and Talwalkar, Non-stochastic Best Arm Identification,
/// 2016): of many candidates that were judged cheaply, few are judged with more care.
struct Halving {
  std::size_t keep{};         ///< how many go on, without those that stay
  double random_share{0.05};  ///< of `keep`: any that was made, since cheap judges err
  double most_cost{std::numeric_limits<double>::infinity()};  ///< others go on last
  std::uint64_t seed{}, step{};
};

/// Who goes on, in the order of the candidates. Half of the places go to those of the least error
/// within `most_cost`, the other half to those whose error none of the same cost or less undercuts,
/// then to those that only these undercut, and so on: so that cheap ones go on too. Of equals the
/// first is taken. O(n log n) a layer.
[[nodiscard]] std::vector<std::size_t> survivors(std::span<const Judged> candidates,
                                                 const Halving& step);

/// The Pareto front: those that no other one undercuts in error and cost, by growing cost; the
/// error falls from each to the next. Of equals the first is taken. O(n log n).
///
/// @param most_cost  others are left out
[[nodiscard]] std::vector<std::size_t> pareto_front(
    std::span<const Judged> candidates, double most_cost = std::numeric_limits<double>::infinity());

/// Of the Pareto front those that are shown, about eight. The least error stays. Nobody takes one
/// beside which a better one costs about the same; of the others those stay that take off most
/// error. For each of `shorter` one stays that is no worse in error and cost, so that more
/// candidates never show less. O(n log n).
///
/// @param shorter  what was shown of the first of these candidates, before the others were known
[[nodiscard]] std::vector<std::size_t> shown_front(std::span<const Judged> candidates,
                                                   std::span<const std::size_t> shorter);

}  // namespace popcut
