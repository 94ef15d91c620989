// SPDX-License-Identifier: MIT
#pragma once

#include <limits>
#include <memory>
#include <vector>

#include "core/design/facets/labels.hpp"
#include "core/design/facets/seen_target.hpp"
#include "core/design/facets/strip_chain.hpp"

namespace popcut {

/// What a card of facets pays for beside its distance from the target, which is in mm of a plane's
/// own offset times mm^2 of sheet: a line of 1 mm costs as much as this area 1 mm off, mm^2.
struct FacetWeights {
  double fold_mm2{1.0};  ///< a fold
  double jump_mm2{4.0};  ///< a cut across a strip
  double cut_mm2{1.0};   ///< a cut between strips
  /// A hinge, however long: as much as this volume between card and target, mm^3. Folds of strips
  /// side by side between the same two planes are one hinge.
  double hinge_mm3{};
};

/// What the labels must obey.
struct FacetLimits {
  int least_run{1};  ///< steps that a plane keeps at least
  double most_reach_mm{std::numeric_limits<double>::infinity()};  ///< x + z of all points
  bool inward{};  ///< points may lie behind wall and ground
};

/// Labels that a strip must not take in some columns.
struct LabelBan {
  int strip{};
  int begin{}, end{};
  Label label{};

  friend bool operator==(const LabelBan&, const LabelBan&) = default;
};

/// The labels of a sheet as a choice between the distance from the target and the length of its
/// folds and cuts: strips by dynamic programming, each beside its neighbours as they are.
class Labelling {
 public:
  Labelling(const SeenTarget& target, const FacetPlanes& planes, const FacetGrid& grid,
            const FacetWeights& weights, const FacetLimits& limits);

  [[nodiscard]] const LabelImage& image() const { return image_; }
  [[nodiscard]] const FacetPlanes& planes() const { return *planes_; }
  [[nodiscard]] const FacetLimits& limits() const { return limits_; }
  [[nodiscard]] const FacetWeights& weights() const { return weights_; }

  /// Every strip, odd and even ones in turn, until nothing changes or `sweeps` are done. The first
  /// sweeps take the neighbours less seriously.
  void sweep(int sweeps, bool jumps);

  /// The best labels of one strip beside its neighbours, without setting them.
  [[nodiscard]] std::vector<Label> best(int strip, bool jumps);

  void set(int strip, const std::vector<Label>& labels);
  /// Gives a strip labels that it keeps: `best` gives no other ones. Before anything else is asked.
  void fix(int strip, const std::vector<Label>& labels);
  [[nodiscard]] bool is_fixed(int strip) const {
    return fixed_[static_cast<std::size_t>(strip)] != 0;
  }
  void ban(const LabelBan& ban) { bans_.push_back(ban); }
  /// Takes the last bans back, so that `count` are left.
  void forget_bans(std::size_t count) { bans_.resize(count); }
  [[nodiscard]] std::size_t bans() const { return bans_.size(); }

  /// Whether the limits let a run be where it is.
  [[nodiscard]] bool allows(const LabelRun& run) const;

  /// What a strip costs, with the cuts to its neighbours.
  [[nodiscard]] double cost(int strip, std::span<const Label> labels) const;
  /// `cost` of a strip as it is.
  [[nodiscard]] double cost_now(int strip) const;
  /// What all strips cost together; a cut between two of them counts for both, a hinge once.
  [[nodiscard]] double whole_cost() const;
  /// The distance from the target of one cell, mm^3; `kForbidden` and more where limits forbid it.
  [[nodiscard]] double cell_distance(int strip, int column, Label label) const;
  /// Its distance from the target alone, mm^3.
  [[nodiscard]] double distance(int strip, std::span<const Label> labels) const;
  /// No labels of these planes come nearer: jumps and folds are free, and strips stand alone. mm^3.
  /// A run that is as long as two can be parted, so that only runs of one to two times the least
  /// length are looked at. O(cells x labels x least run). Copies of this labelling share the costs
  /// that are computed here.
  [[nodiscard]] double least_distance();
  /// Whether `cell_distance` of a strip is a look into costs that are kept.
  [[nodiscard]] bool keeps_costs(int strip) const {
    return kept_ != nullptr && !(*kept_)[static_cast<std::size_t>(strip)].empty();
  }
  /// These costs, of each label in each column.
  [[nodiscard]] std::span<const float> kept_costs(int strip) const {
    return (*kept_)[static_cast<std::size_t>(strip)];
  }

 private:
  /// What each label costs in each column.
  void load_costs(int strip, std::vector<double>& into);
  /// The distance from the target of a cell of a kite, mm^3.
  [[nodiscard]] double kite_distance(std::size_t strip, std::size_t column,
                                     const FacetPlane& plane) const;
  /// Whether the same is seen in both strips.
  [[nodiscard]] bool look_alike(int strip, int other) const;
  void compute(int strip, double* cost) const;
  /// The label of a column in strip `other`, or of the card's margin.
  [[nodiscard]] Label label_beside(int other, int column) const;
  /// Whether the labels of `other` at the line before a column are `before` and `after`.
  [[nodiscard]] bool goes_on(int other, int column, Label before, Label after) const;
  /// How many folds of a strip go on in strip `other`.
  [[nodiscard]] int shared_folds(std::span<const Label> labels, int other) const;
  /// In how many columns strip `other`, or the card's margin, has another label.
  [[nodiscard]] int differing(std::span<const Label> labels, int other) const;
  /// The folds of the strips beside a strip, each worth `gain` to it, into `beside_`.
  void find_folds_beside(int strip, double gain);
  /// What the best labels of a strip follow from beside its costs, and these labels.
  struct SolvedStrip {
    bool jumps{};
    double coupling{};
    std::vector<Label> beside;   ///< of the strips before and after it
    std::vector<LabelBan> bans;  ///< in it
    std::vector<Label> labels;
  };
  [[nodiscard]] std::vector<Label> solve(int strip, bool jumps, double coupling);
  [[nodiscard]] std::vector<Label> solve_anew(const SolvedStrip& what, int strip);

  const SeenTarget* target_;
  const FacetPlanes* planes_;
  FacetGrid grid_;
  FacetWeights weights_;
  FacetLimits limits_;
  LabelImage image_;
  std::vector<LabelBan> bans_;
  std::vector<std::uint8_t> fixed_;  ///< one a strip
  /// Costs of strips, empty until they are computed; null where not all of them fit.
  std::shared_ptr<std::vector<std::vector<float>>> kept_;
  std::vector<double> cost_;         ///< of the strip that was computed last
  mutable std::vector<double> now_;  ///< `cost_now` of each strip; below 0: not known
  std::vector<double> problem_, next_;
  std::vector<FoldBeside> beside_, solved_beside_;
  double solved_fold_{};
  int computed_{-1};  ///< the strip whose costs are in `cost_`, where none are kept
  FacetChainSolver solver_;
  std::vector<std::vector<SolvedStrip>> known_;  ///< the last ones of each strip, the newest first
  bool solved_jumps_{};
  std::vector<Label> solved_;  ///< of `problem_`; empty: none yet
};

}  // namespace popcut
