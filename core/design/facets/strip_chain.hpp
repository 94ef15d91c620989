// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <vector>

#include "core/design/facets/labels.hpp"

namespace popcut {

/// A cost that no chain pays where another one exists.
inline constexpr double kForbidden = 1e7;

/// A fold that goes on in a strip beside this one: into `into` at the line before `column`.
struct FoldBeside {
  int column{};
  Label into{};
  double gain{};  ///< what it costs less than others
  friend bool operator==(const FoldBeside&, const FoldBeside&) = default;
};

/// The labels of one strip as a shortest path: what each column costs under each label, and what it
/// costs to go on in another plane.
struct FacetChainProblem {
  std::span<const double> cost;  ///< columns x labels; `kForbidden` and more: not to be taken
  int least_run{1};              ///< columns that a plane keeps at least
  double fold{};                 ///< a fold into the plane that meets this one there
  double jump{kForbidden};       ///< a cut across the strip, into any plane that it does not meet
  std::span<const FoldBeside> beside{};  ///< by column
};

struct FacetChain {
  std::vector<Label> label;  ///< one a column, from the wall to the ground
  double cost{};
};

/// The cheapest labels of a strip that begin with the wall and end with the ground, exactly:
/// dynamic programming over columns with three moves (stay, fold, jump), each jump through the two
/// least costs of all labels there. O(columns x labels).
class FacetChainSolver {
 public:
  FacetChainSolver(const FacetPlanes& planes, const FacetGrid& grid);

  [[nodiscard]] FacetChain solve(const FacetChainProblem& problem);

 private:
  void enter(const FacetChainProblem& problem, std::size_t column);
  void jump_into(const FacetChainProblem& problem, double* here, double* into, Label* from,
                 std::size_t column);
  /// The costs of all labels at a line, of the last `rows_` lines.
  [[nodiscard]] double* row(std::vector<double>& costs, std::size_t line) const {
    return costs.data() + line % rows_ * labels_;
  }

  std::size_t labels_, columns_;
  std::vector<Label>
      partners_;  ///< columns x labels: the plane that each one meets at the line before
  std::size_t rows_{1};
  std::vector<double> whole_;          ///< by label: in it for `least_run` columns or more
  std::vector<double> entered_;        ///< comes into it at this line
  std::vector<double> sum_;            ///< of the costs of a label so far
  std::vector<Label> from_;            ///< (columns + 1) x labels: label before the entry
  std::vector<unsigned char> begins_;  ///< the run begins `least_run` columns before
  std::size_t beside_{};               ///< the first of `beside` that is not behind
};

}  // namespace popcut
