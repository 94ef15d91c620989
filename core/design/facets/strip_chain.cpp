// SPDX-License-Identifier: MIT
#include "core/design/facets/strip_chain.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <utility>

namespace popcut {
namespace {

constexpr double kNever = 1e30;

/// Index of the first least value. Four at a time, since each comparison waits for the one before.
std::size_t least_of(std::span<const double> values) {
  std::array least{kNever, kNever, kNever, kNever};
  std::size_t k = 0;
  for (; k + 4 <= values.size(); k += 4)
    for (std::size_t i = 0; i < 4; ++i) least[i] = std::min(least[i], values[k + i]);
  for (; k < values.size(); ++k) least[0] = std::min(least[0], values[k]);
  const double all = std::min(std::min(least[0], least[1]), std::min(least[2], least[3]));
  const auto found = std::find_if(values.begin(), values.end(), [&](double v) { return v <= all; });
  return found == values.end() ? 0 : static_cast<std::size_t>(found - values.begin());
}

}  // namespace

FacetChainSolver::FacetChainSolver(const FacetPlanes& planes, const FacetGrid& grid)
    : labels_(planes.size()), columns_(static_cast<std::size_t>(grid.columns)) {
  partners_.reserve(columns_ * labels_);
  for (int i = 0; i < grid.columns; ++i)
    for (std::size_t l = 0; l < labels_; ++l)
      partners_.push_back(planes.partner(static_cast<Label>(l), grid.across(i)));
}

/// Into each label at the line before `column`: by a fold, or by a jump.
void FacetChainSolver::enter(const FacetChainProblem& problem, std::size_t column) {
  const std::size_t labels = labels_;
  double* const here = whole_.data();
  double* const into = row(entered_, column);
  Label* const from = from_.data() + column * labels;
  jump_into(problem, here, into, from, column);
  // Whoever meets a plane is met by it, and by no other one: so each is entered once.
  const Label* const met = partners_.data() + column * labels;
  for (std::size_t l = 0; l < labels; ++l) {
    if (met[l] == kNoLabel) continue;
    const double cost = here[met[l]] + problem.fold;
    if (!(here[met[l]] < kNever) || cost > into[l]) continue;
    into[l] = cost;
    from[l] = met[l];
  }
  for (; beside_ < problem.beside.size() &&
         problem.beside[beside_].column <= static_cast<int>(column);
       ++beside_) {
    const FoldBeside& fold = problem.beside[beside_];
    const Label before = met[fold.into];
    if (fold.column != static_cast<int>(column) || before == kNoLabel || !(here[before] < kNever))
      continue;
    const double cost = here[before] + problem.fold - fold.gain;
    if (cost > into[fold.into]) continue;
    into[fold.into] = cost;
    from[fold.into] = before;
  }
}

/// Into each label at the line before `column` by a jump: from the least label, but into the plane
/// that this one meets there, which would be a fold.
void FacetChainSolver::jump_into(const FacetChainProblem& problem, double* here, double* into,
                                 Label* from, std::size_t column) {
  const std::size_t labels = labels_;
  const std::size_t least = least_of({here, labels});
  std::fill(into, into + labels, std::min(kNever, here[least] + problem.jump));
  std::fill(from, from + labels, static_cast<Label>(least));
  if (problem.jump >= problem.fold) return;  // the fold is as good
  const Label met = partners_[column * labels + least];
  if (met == kNoLabel) return;
  const double cost = std::exchange(here[least], kNever);
  const std::size_t second = least_of({here, labels});
  into[met] = std::min(kNever, here[second] + problem.jump);
  from[met] = static_cast<Label>(second);
  here[least] = cost;
}

FacetChain FacetChainSolver::solve(const FacetChainProblem& problem) {
  const std::size_t labels = labels_;
  const std::size_t columns = columns_;
  const auto run = static_cast<std::size_t>(std::max(1, problem.least_run));
  // Of costs only the last lines are needed; of where they come from, all.
  rows_ = std::min(run, columns) + 1;
  whole_.assign(labels, kNever);
  entered_.resize(rows_ * labels);
  sum_.resize(rows_ * labels);
  from_.resize((columns + 1) * labels);
  begins_.resize((columns + 1) * labels);
  std::fill_n(entered_.begin(), labels, kNever);
  std::fill_n(sum_.begin(), labels, 0.0);
  std::fill_n(from_.begin(), labels, kNoLabel);
  std::fill_n(begins_.begin(), std::min(columns + 1, run) * labels, std::uint8_t{0});
  entered_[kWallLabel] = 0.0;
  beside_ = 0;
  double* const whole = whole_.data();
  for (std::size_t i = 1; i <= columns; ++i) {
    const double* const cost = problem.cost.data() + (i - 1) * labels;
    const double* const sum_last = row(sum_, i - 1);
    double* const sum = row(sum_, i);
    for (std::size_t l = 0; l < labels; ++l) sum[l] = sum_last[l] + cost[l];
    for (std::size_t l = 0; l < labels; ++l) whole[l] += cost[l];
    if (i >= run) {
      const double* const before = row(entered_, i - run);
      const double* const sum_before = row(sum_, i - run);
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
  out.cost = whole[kGroundLabel];
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
