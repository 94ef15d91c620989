// SPDX-License-Identifier: MIT
#include "core/design/facets/labelling.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

namespace popcut {
namespace {

constexpr std::size_t kMostKept = 40'000'000;  ///< costs that are kept, of four bytes
constexpr std::size_t kMostSolved = 6;         ///< solutions that are kept of each strip

/// What a strip costs at least that is the wall's at its beginning and the ground's at its end,
/// where each run has `run` columns or more and changes are free.
///
/// @param cost  of each label in each column
template <typename Cost>
double least_of_runs(std::span<const Cost> cost, std::size_t labels, std::size_t run) {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  const std::size_t columns = cost.size() / labels;
  std::vector<double> least(columns + 1, kNever);  // of the columns before each line
  std::vector<double> sums(labels);
  least[0] = 0.0;
  for (std::size_t begin = 0; begin < columns; ++begin) {
    if (least[begin] == kNever) continue;
    std::fill(sums.begin(), sums.end(), 0.0);
    for (std::size_t end = begin + 1; end <= std::min(columns, begin + 2 * run - 1); ++end) {
      const Cost* const here = cost.data() + (end - 1) * labels;
      for (std::size_t l = 0; l < labels; ++l) sums[l] += static_cast<double>(here[l]);
      if (end - begin < run) continue;
      const double all = begin == 0       ? sums[kWallLabel]
                         : end == columns ? sums[kGroundLabel]
                                          : *std::min_element(sums.begin(), sums.end());
      least[end] = std::min(least[end], least[begin] + all);
    }
  }
  return least[columns];
}

}  // namespace

Labelling::Labelling(const SeenTarget& target, const FacetPlanes& planes, const FacetGrid& grid,
                     const FacetWeights& weights, const FacetLimits& limits)
    : target_(&target),
      planes_(&planes),
      grid_(grid),
      weights_(weights),
      limits_(limits),
      solver_(planes, grid) {
  const auto columns = static_cast<std::size_t>(grid.columns);
  image_.grid = grid;
  image_.label.assign(columns * static_cast<std::size_t>(grid.strips), kGroundLabel);
  for (int s = 0; s < grid.strips; ++s) std::fill_n(image_.strip(s).begin(), grid.wall, kWallLabel);
  fixed_.assign(static_cast<std::size_t>(grid.strips), 0);
  known_.resize(static_cast<std::size_t>(grid.strips));
  now_.assign(static_cast<std::size_t>(grid.strips), -1.0);
  cost_.resize(columns * planes.size());
  if (image_.label.size() * planes.size() <= kMostKept)
    kept_ =
        std::make_shared<std::vector<std::vector<float>>>(static_cast<std::size_t>(grid.strips));
}

/// The cost of each label in each column: the sum over the points of the target's picture there of
/// how far the plane would have to be moved along its normal to go through what is seen.
void Labelling::compute(int strip, double* cost) const {
  const SheetRaster& raster = target_->raster;
  const std::size_t across = raster.columns / static_cast<std::size_t>(grid_.columns);
  const std::size_t along = raster.rows / static_cast<std::size_t>(grid_.strips);
  const double area = raster.column_mm * raster.row_mm, step = grid_.step_mm;
  const std::size_t labels = planes_->size();
  std::fill_n(cost, labels * static_cast<std::size_t>(grid_.columns), 0.0);
  std::vector<double> offset(labels);
  const FacetPlane* const planes = &(*planes_)[0];
  std::size_t first_level = labels;
  for (std::size_t l = 2; l < labels && first_level == labels; ++l)
    if (!(*planes_)[static_cast<Label>(l)].upright) first_level = l;
  for (std::size_t l = 0; l < labels; ++l)
    offset[l] = step * (*planes_)[static_cast<Label>(l)].offset;
  for (std::size_t column = 0; column < static_cast<std::size_t>(grid_.columns); ++column) {
    double* const out = cost + column * labels;
    const int begin = grid_.across(static_cast<int>(column));
    // Planes that would be behind the card here are forbidden, however near.
    std::size_t upright = 2, level = first_level;
    if (!limits_.inward) {
      while (upright < first_level && planes[upright].offset < begin + 1) ++upright;
      while (level < labels && planes[level].offset < -begin) ++level;
    }
    for (std::size_t r = 0; r < along; ++r)
      for (std::size_t c = 0; c < across; ++c) {
        const std::size_t row = static_cast<std::size_t>(strip) * along + r,
                          at = column * across + c;
        const double x = target_->x_mm(row, at), z = target_->z_mm(row, at);
        out[kWallLabel] += std::abs(x), out[kGroundLabel] += std::abs(z);
        for (std::size_t l = upright; l < first_level; ++l) out[l] += std::abs(offset[l] - x);
        for (std::size_t l = level; l < labels; ++l) out[l] += std::abs(offset[l] - z);
      }
    for (std::size_t l = 0; l < labels; ++l) {
      out[l] *= area;
      const FacetPlane& plane = (*planes_)[static_cast<Label>(l)];
      if (plane.kite >= 0) {
        const bool here = is_fixed(strip) && planes_->is_at_kite(plane, begin);
        out[l] = here ? kite_distance(static_cast<std::size_t>(strip), column, plane) : kForbidden;
        continue;
      }
      const int reach = plane.upright ? 2 * plane.offset - begin : 2 * plane.offset + begin + 1;
      if (step * reach > limits_.most_reach_mm && plane.offset != 0) out[l] += kForbidden;
      const bool is_behind =
          plane.upright ? begin + 1 > plane.offset : begin < -plane.offset;  // z or x below 0
      if (is_behind && !limits_.inward) out[l] += kForbidden;
    }
  }
}

void Labelling::fix(int strip, const std::vector<Label>& labels) {
  fixed_[static_cast<std::size_t>(strip)] = 1;
  set(strip, labels);
}

/// The picture of a kite is as long as its paper, though no panel's is: what is seen of it through
/// the column.
double Labelling::kite_distance(std::size_t strip, std::size_t column,
                                const FacetPlane& plane) const {
  const SheetRaster& raster = target_->raster;
  const std::size_t across = raster.columns / static_cast<std::size_t>(grid_.columns);
  const std::size_t along = raster.rows / static_cast<std::size_t>(grid_.strips);
  const KiteSection kite =
      planes_->kites()[static_cast<std::size_t>(plane.kite)].section(grid_.step_mm);
  double sum = 0.0;
  for (std::size_t c = column * across; c < (column + 1) * across; ++c) {
    const double depth = kite.depth_mm(raster.across_mm(c));
    for (std::size_t row = strip * along; row < (strip + 1) * along; ++row)
      sum +=
          0.5 * std::abs(depth - static_cast<double>(target_->depth_mm[row * raster.columns + c]));
  }
  return sum * raster.column_mm * raster.row_mm;
}

bool Labelling::look_alike(int strip, int other) const {
  if (is_fixed(strip) || is_fixed(other)) return false;
  const SheetRaster& raster = target_->raster;
  const auto count = static_cast<std::ptrdiff_t>(
      raster.columns * (raster.rows / static_cast<std::size_t>(grid_.strips)));
  const auto first = target_->depth_mm.begin() + count * strip;
  return std::equal(first, first + count, target_->depth_mm.begin() + count * other);
}

void Labelling::load_costs(int strip, std::vector<double>& into) {
  if (kept_ == nullptr) {
    if (computed_ < 0 || !look_alike(computed_, strip)) compute(strip, cost_.data());
    computed_ = strip;
    into = cost_;
    return;
  }
  std::vector<float>& kept = (*kept_)[static_cast<std::size_t>(strip)];
  if (kept.empty()) {
    compute(strip, cost_.data());
    kept.assign(cost_.begin(), cost_.end());
    now_[static_cast<std::size_t>(strip)] = -1.0;  // of costs that are not rounded
    into = cost_;
  } else {
    into.assign(kept.begin(), kept.end());
  }
}

/// A repair asks for the same strips round after round, while it changes few of them.
std::vector<Label> Labelling::solve(int strip, bool jumps, double coupling) {
  if (is_fixed(strip)) return {image_.strip(strip).begin(), image_.strip(strip).end()};
  SolvedStrip what{jumps, coupling, {}, {}, {}};
  for (const int other : {strip - 1, strip + 1})
    for (int i = 0; i < grid_.columns; ++i) what.beside.push_back(label_beside(other, i));
  std::copy_if(bans_.begin(), bans_.end(), std::back_inserter(what.bans),
               [&](const LabelBan& ban) { return ban.strip == strip; });
  auto& known = known_[static_cast<std::size_t>(strip)];
  auto at = std::find_if(known.begin(), known.end(), [&](const SolvedStrip& one) {
    return one.jumps == jumps && one.coupling == coupling && one.beside == what.beside &&
           one.bans == what.bans;
  });
  if (at == known.end()) {
    what.labels = solve_anew(what, strip);
    if (known.size() == kMostSolved) known.pop_back();
    at = known.insert(known.end(), std::move(what));
  }
  std::rotate(known.begin(), at, at + 1);
  return known.front().labels;
}

std::vector<Label> Labelling::solve_anew(const SolvedStrip& what, int strip) {
  const std::size_t labels = planes_->size(), columns = static_cast<std::size_t>(grid_.columns);
  load_costs(strip, next_);
  for (std::size_t k = 0; k < what.beside.size(); ++k)
    next_[(k % columns) * labels + static_cast<std::size_t>(what.beside[k])] -=
        what.coupling * weights_.cut_mm2 * grid_.step_mm;
  const double hinge = what.coupling * weights_.hinge_mm3;
  if (hinge > 0.0) find_folds_beside(strip, hinge);
  for (const LabelBan& ban : what.bans)
    for (int i = ban.begin; i < ban.end; ++i)
      next_[static_cast<std::size_t>(i) * labels + static_cast<std::size_t>(ban.label)] +=
          kForbidden;
  const double width = grid_.strip_mm, fold = weights_.fold_mm2 * width + hinge;
  // Strips of a flat front are often one and the same problem.
  if (!solved_.empty() && what.jumps == solved_jumps_ && fold == solved_fold_ &&
      next_ == problem_ && beside_ == solved_beside_)
    return solved_;
  problem_.swap(next_);
  solved_jumps_ = what.jumps, solved_fold_ = fold, solved_beside_ = beside_;
  solved_ =
      solver_
          .solve({problem_, limits_.least_run, fold,
                  what.jumps ? std::max(weights_.jump_mm2, weights_.fold_mm2) * width : kForbidden,
                  beside_})
          .label;
  return solved_;
}

Label Labelling::label_beside(int other, int column) const {
  if (other >= 0 && other < grid_.strips)
    return image_.strip(other)[static_cast<std::size_t>(column)];
  return column < grid_.wall ? kWallLabel : kGroundLabel;
}

bool Labelling::goes_on(int other, int column, Label before, Label after) const {
  return label_beside(other, column - 1) == before && label_beside(other, column) == after;
}

int Labelling::shared_folds(std::span<const Label> labels, int other) const {
  int shared = 0;
  for (std::size_t i = 1; i < labels.size(); ++i)
    if (labels[i] != labels[i - 1] &&
        goes_on(other, static_cast<int>(i), labels[i - 1], labels[i]) &&
        planes_->meet(labels[i - 1], labels[i], grid_.across(static_cast<int>(i))))
      ++shared;
  return shared;
}

int Labelling::differing(std::span<const Label> labels, int other) const {
  int count = 0;
  if (other >= 0 && other < grid_.strips) {
    const Label* const beside = std::as_const(image_).strip(other).data();
    const Label* const own = labels.data();
    for (std::size_t i = 0; i < labels.size(); ++i) count += own[i] != beside[i] ? 1 : 0;
    return count;
  }
  for (std::size_t i = 0; i < labels.size(); ++i)
    count += labels[i] != label_beside(other, static_cast<int>(i)) ? 1 : 0;
  return count;
}

void Labelling::find_folds_beside(int strip, double gain) {
  beside_.clear();
  for (int i = 1; i < grid_.columns; ++i)
    for (const int other : {strip - 1, strip + 1}) {
      const Label before = label_beside(other, i - 1), after = label_beside(other, i);
      if (before == after || planes_->is_of_kite(before) || planes_->is_of_kite(after) ||
          !planes_->meet(before, after, grid_.across(i)))
        continue;
      if (!beside_.empty() && beside_.back().column == i && beside_.back().into == after)
        beside_.back().gain += gain;
      else
        beside_.push_back({i, after, gain});
    }
}

void Labelling::sweep(int sweeps, bool jumps) {
  std::vector<std::uint8_t> stale(static_cast<std::size_t>(grid_.strips), 1);
  const int ramp = sweeps / 2;
  for (int k = 0; k < sweeps; ++k) {
    const double coupling = k >= ramp ? 1.0 : static_cast<double>(k) / ramp;
    if (k <= ramp) std::fill(stale.begin(), stale.end(), std::uint8_t{1});
    bool changed = false;
    for (const int parity : {0, 1})
      for (int s = parity; s < grid_.strips; s += 2) {
        const auto at = static_cast<std::size_t>(s);
        if (stale[at] == 0) continue;
        stale[at] = 0;
        std::vector<Label> labels = solve(s, jumps, coupling);
        if (std::equal(labels.begin(), labels.end(), image_.strip(s).begin())) continue;
        changed = true;
        set(s, labels);
        if (s > 0) stale[at - 1] = 1;
        if (at + 1 < stale.size()) stale[at + 1] = 1;
      }
    if (!changed && k > ramp) break;
  }
}

std::vector<Label> Labelling::best(int strip, bool jumps) { return solve(strip, jumps, 1.0); }

void Labelling::set(int strip, const std::vector<Label>& labels) {
  std::copy(labels.begin(), labels.end(), image_.strip(strip).begin());
  for (int s = std::max(0, strip - 1); s <= std::min(grid_.strips - 1, strip + 1); ++s)
    now_[static_cast<std::size_t>(s)] = -1.0;
}

bool Labelling::allows(const LabelRun& run) const {
  const FacetPlane& plane = (*planes_)[run.label];
  const int first = grid_.across(run.begin), last = grid_.across(run.end);
  if (plane.kite >= 0)
    return planes_->is_at_kite(plane, first) && planes_->is_at_kite(plane, last - 1) &&
           !planes_->is_at_kite(plane, first - 1) && !planes_->is_at_kite(plane, last);
  const bool is_behind = plane.upright ? last > plane.offset : first < -plane.offset;
  if (run.end - run.begin < limits_.least_run || (is_behind && !limits_.inward)) return false;
  const int reach = plane.upright ? 2 * plane.offset - first : 2 * plane.offset + last;
  return plane.offset == 0 || grid_.step_mm * reach <= limits_.most_reach_mm;
}

double Labelling::cell_distance(int strip, int column, Label label) const {
  const auto at_strip = static_cast<std::size_t>(strip);
  if (keeps_costs(strip))
    return static_cast<double>(
        (*kept_)[at_strip][static_cast<std::size_t>(column) * planes_->size() +
                           static_cast<std::size_t>(label)]);
  const SheetRaster& raster = target_->raster;
  const std::size_t across = raster.columns / static_cast<std::size_t>(grid_.columns);
  const std::size_t along = raster.rows / static_cast<std::size_t>(grid_.strips);
  const FacetPlane& plane = (*planes_)[label];
  if (plane.kite >= 0) return kite_distance(at_strip, static_cast<std::size_t>(column), plane);
  const double offset = grid_.step_mm * plane.offset;
  double sum = 0.0;
  for (std::size_t row = at_strip * along; row < (at_strip + 1) * along; ++row)
    for (std::size_t c = 0; c < across; ++c) {
      const std::size_t at = static_cast<std::size_t>(column) * across + c;
      sum += std::abs(offset - (plane.upright ? target_->x_mm(row, at) : target_->z_mm(row, at)));
    }
  return sum * raster.column_mm * raster.row_mm;
}

double Labelling::distance(int strip, std::span<const Label> labels) const {
  const SheetRaster& raster = target_->raster;
  const std::size_t across = raster.columns / static_cast<std::size_t>(grid_.columns);
  const std::size_t along = raster.rows / static_cast<std::size_t>(grid_.strips);
  double sum = 0.0, of_kites = 0.0;
  for (std::size_t column = 0; column < labels.size(); ++column) {
    const FacetPlane& plane = (*planes_)[labels[column]];
    if (plane.kite >= 0) {
      of_kites += kite_distance(static_cast<std::size_t>(strip), column, plane);
      continue;
    }
    const double offset = grid_.step_mm * plane.offset;
    for (std::size_t r = 0; r < along; ++r)
      for (std::size_t c = 0; c < across; ++c) {
        const std::size_t row = static_cast<std::size_t>(strip) * along + r,
                          at = column * across + c;
        sum += std::abs(offset - (plane.upright ? target_->x_mm(row, at) : target_->z_mm(row, at)));
      }
  }
  return sum * raster.column_mm * raster.row_mm + of_kites;
}

double Labelling::cost(int strip, std::span<const Label> labels) const {
  double sum = 0.0;
  if (keeps_costs(strip)) {
    const float* cost = (*kept_)[static_cast<std::size_t>(strip)].data();
    for (const Label label : labels) {
      sum += static_cast<double>(cost[label]);
      cost += planes_->size();
    }
  } else {
    sum = distance(strip, labels);
  }
  int hinges = 0;
  for (std::size_t i = 1; i < labels.size(); ++i)
    if (labels[i] != labels[i - 1]) {
      const int column = static_cast<int>(i);
      const bool is_fold = planes_->meet(labels[i - 1], labels[i], grid_.across(column));
      sum += grid_.strip_mm * (is_fold ? weights_.fold_mm2 : weights_.jump_mm2);
      if (!is_fold || !(weights_.hinge_mm3 > 0.0)) continue;
      ++hinges;
      for (const int other : {strip - 1, strip + 1})
        hinges -= goes_on(other, column, labels[i - 1], labels[i]) ? 1 : 0;
    }
  const int cut = differing(labels, strip - 1) + differing(labels, strip + 1);
  return sum + weights_.cut_mm2 * grid_.step_mm * cut + weights_.hinge_mm3 * hinges;
}

double Labelling::cost_now(int strip) const {
  double& known = now_[static_cast<std::size_t>(strip)];
  if (known < 0.0) known = cost(strip, image_.strip(strip));
  return known;
}

double Labelling::whole_cost() const {
  double sum = 0.0;
  for (int s = 0; s < grid_.strips; ++s) {
    sum += cost(s, image_.strip(s));
    if (weights_.hinge_mm3 > 0.0 && s > 0)
      sum += weights_.hinge_mm3 * shared_folds(image_.strip(s), s - 1);
  }
  return sum;
}

double Labelling::least_distance() {
  const std::size_t cells = static_cast<std::size_t>(grid_.columns) * planes_->size();
  const auto run = static_cast<std::size_t>(std::max(1, limits_.least_run));
  double sum = 0.0;
  for (int s = 0; s < grid_.strips; ++s) {
    if (keeps_costs(s)) {
      const std::vector<float>& kept = (*kept_)[static_cast<std::size_t>(s)];
      sum += least_of_runs(std::span<const float>(kept), planes_->size(), run);
      continue;
    }
    load_costs(s, next_);
    sum += least_of_runs(std::span<const double>(next_).first(cells), planes_->size(), run);
  }
  return sum;
}

}  // namespace popcut
