// SPDX-License-Identifier: MIT
#include "core/design/facets/strip_chain.hpp"

#include <algorithm>

namespace popcut {
namespace {

constexpr double kNever = 1e30;

}  // namespace

/// Into each label at the line before `column`: by a fold, or by a jump.
void FacetChainSolver::enter(const FacetChainProblem& problem, std::size_t column) {
  const std::size_t labels = problem.planes.size();
  const double* const here = whole_.data() + column * labels;
  double* const into = entered_.data() + column * labels;
  Label* const from = from_.data() + column * labels;
  const auto least = static_cast<std::size_t>(std::min_element(here, here + labels) - here);
  std::fill(into, into + labels, std::min(kNever, here[least] + problem.jump));
  std::fill(from, from + labels, static_cast<Label>(least));
  const int across = problem.grid.across(static_cast<int>(column));
  for (std::size_t l = 0; l < labels; ++l) {
    if (!(here[l] < kNever)) continue;
    const Label other = problem.planes.partner(static_cast<Label>(l), across);
    if (other == kNoLabel || here[l] + problem.fold > into[other]) continue;
    into[other] = here[l] + problem.fold;
    from[other] = static_cast<Label>(l);
  }
}

FacetChain FacetChainSolver::solve(const FacetChainProblem& problem) {
  const std::size_t labels = problem.planes.size();
  const auto columns = static_cast<std::size_t>(problem.grid.columns);
  const auto run = static_cast<std::size_t>(std::max(1, problem.least_run));
  whole_.assign((columns + 1) * labels, kNever);
  entered_.assign((columns + 1) * labels, kNever);
  sum_.assign((columns + 1) * labels, 0.0);
  from_.assign((columns + 1) * labels, kNoLabel);
  begins_.assign((columns + 1) * labels, 0);
  entered_[kWallLabel] = 0.0;
  for (std::size_t i = 1; i <= columns; ++i) {
    const double* const cost = problem.cost.data() + (i - 1) * labels;
    double* const sum = sum_.data() + i * labels;
    double* const whole = whole_.data() + i * labels;
    for (std::size_t l = 0; l < labels; ++l) sum[l] = (sum - labels)[l] + cost[l];
    for (std::size_t l = 0; l < labels; ++l) whole[l] = (whole - labels)[l] + cost[l];
    if (i >= run) {
      const double* const before = entered_.data() + (i - run) * labels;
      const double* const sum_before = sum_.data() + (i - run) * labels;
      unsigned char* const begins = begins_.data() + i * labels;
      for (std::size_t l = 0; l < labels; ++l) {
        const double all = before[l] + (sum[l] - sum_before[l]);
        begins[l] = all < whole[l] ? 1 : 0;
        whole[l] = std::min(whole[l], all);
      }
    }
    if (i < columns) enter(problem, i);
  }
  FacetChain out;
  out.cost = whole_[columns * labels + kGroundLabel];
  out.label.assign(columns, kWallLabel);
  Label label = kGroundLabel;
  for (std::size_t i = columns; i > 0;) {
    const std::size_t at = i * labels + static_cast<std::size_t>(label);
    if (begins_[at] == 0) {
      out.label[--i] = label;
      continue;
    }
    const std::size_t begin = i - run;
    std::fill(out.label.begin() + static_cast<std::ptrdiff_t>(begin),
              out.label.begin() + static_cast<std::ptrdiff_t>(i), label);
    label = from_[begin * labels + static_cast<std::size_t>(label)];
    i = begin;
  }
  return out;
}

}  // namespace popcut
