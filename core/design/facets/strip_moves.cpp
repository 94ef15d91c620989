// SPDX-License-Identifier: MIT
#include "core/design/facets/strip_moves.hpp"

#include <algorithm>
#include <cstdlib>
#include <utility>

namespace popcut {
namespace {

constexpr int kLedgeReach = 8;  ///< steps from a cut, where no plane is tried just there
constexpr int kMostShift = 8;   ///< steps
constexpr int kShifts = 2;      ///< planes that are tried on each side
constexpr int kPaperShifts = 4;
constexpr double kFarthest = 3.0;  ///< times the distance that counts as another place

void paint(std::vector<Label>& labels, int begin, int end, Label label) {
  std::fill(labels.begin() + begin, labels.begin() + end, label);
}

/// The line where an upright and a level plane meet.
int fold_of(const FacetGrid& grid, const FacetPlane& p, const FacetPlane& q) {
  return grid.wall + (p.upright ? p.offset - q.offset : q.offset - p.offset);
}

/// The ledge that begins at `line`. None without a plane for it, or without room.
std::optional<std::vector<Label>> with_ledge_at(const LabelCard& card, int s, std::size_t r,
                                                int line) {
  const LabelRun &before = card.runs_of_strip(s)[r - 1], &after = card.runs_of_strip(s)[r];
  const Label label = card.planes().partner(before.label, card.grid().across(line));
  if (label == kNoLabel) return std::nullopt;
  const int end = fold_of(card.grid(), card.planes()[label], card.planes()[after.label]);
  const int least = card.labelling.limits().least_run;
  if (line < before.begin + least || end < line + least || end > after.end - least)
    return std::nullopt;
  std::vector<Label> labels = labels_of(card.image(), s);
  paint(labels, before.begin, line, before.label);
  paint(labels, line, end, label);
  paint(labels, end, after.end, after.label);
  return labels;
}

/// Run `r` in another plane, which is `shift` steps farther along the strip.
std::optional<std::vector<Label>> shifted_to(const LabelCard& card, int s, std::size_t r,
                                             Label label, int shift) {
  const std::vector<LabelRun>& runs = card.runs_of_strip(s);
  LabelRun before = runs[r - 1], run = runs[r], after = runs[r + 1];
  if (label == before.label || label == after.label) return std::nullopt;
  run.label = label;
  if (run.folds_on) run.begin = before.end = run.begin + shift;
  if (after.folds_on) run.end = after.begin = run.end + shift;
  std::vector<Label> labels = labels_of(card.image(), s);
  for (const LabelRun& one : {before, run, after}) {
    if (!card.labelling.allows(one)) return std::nullopt;
    paint(labels, one.begin, one.end, one.label);
  }
  return labels;
}

/// The cheapest labels for a strip without one stretch; the same labels if there are none.
std::vector<Label> painted_over(const LabelCard& card, int s, const LabelBan& cell,
                                bool take_beside, std::vector<Label> labels) {
  const FacetGrid& grid = card.grid();
  const auto at = [&](int column) { return labels[static_cast<std::size_t>(column)]; };
  const Label first = cell.begin > 0 ? at(cell.begin - 1) : kWallLabel,
              last = cell.end < grid.columns ? at(cell.end) : kGroundLabel;
  std::vector<Label> best;
  double least = 0.0;
  const auto look = [&](std::vector<Label> other) {
    const double cost = card.labelling.cost(s, other);
    if (best.empty() || cost < least) least = cost, best = std::move(other);
  };
  const auto split_at = [&](int line) {
    std::vector<Label> other = labels;
    paint(other, cell.begin, line, first);
    paint(other, line, cell.end, last);
    look(std::move(other));
  };
  if (last != cell.label) split_at(cell.begin);
  if (first != cell.label) split_at(cell.end);
  const FacetPlane &p = card.planes()[first], &q = card.planes()[last];
  if (p.upright != q.upright) {
    const int fold = fold_of(grid, p, q);
    if (fold > cell.begin && fold < cell.end) split_at(fold);
  }
  for (const int beside : {s - 1, s + 1}) {
    if (!take_beside || beside < 0 || beside >= grid.strips) continue;
    const auto strip = card.image().strip(beside).subspan(
        static_cast<std::size_t>(cell.begin), static_cast<std::size_t>(cell.end - cell.begin));
    if (std::any_of(strip.begin(), strip.end(), [&](Label label) {
          return label == cell.label || card.planes().is_of_kite(label);
        }))
      continue;
    std::vector<Label> other = labels;
    std::copy(strip.begin(), strip.end(), other.begin() + cell.begin);
    if (is_wide(other, card.labelling.limits().least_run)) look(std::move(other));
  }
  return best.empty() ? std::move(labels) : std::move(best);
}

}  // namespace

std::optional<std::vector<Label>> with_meeting(const LabelCard& card, int s, std::size_t a,
                                               std::size_t b) {
  if (card.labelling.is_fixed(s)) return std::nullopt;
  const LabelRun &before = card.runs_of_strip(s)[a], &after = card.runs_of_strip(s)[b];
  const FacetPlane &p = card.planes()[before.label], &q = card.planes()[after.label];
  int fold = before.end;
  if (before.label != after.label) {
    if (p.upright == q.upright) return std::nullopt;
    fold = fold_of(card.grid(), p, q);
    const int least = card.labelling.limits().least_run;
    if (fold < before.begin + least || fold > after.end - least) return std::nullopt;
  }
  std::vector<Label> labels = labels_of(card.image(), s);
  paint(labels, before.begin, fold, before.label);
  paint(labels, fold, after.end, after.label);
  return labels;
}

std::vector<std::vector<Label>> with_ledges(const LabelCard& card, int s, std::size_t r) {
  const LabelRun &before = card.runs_of_strip(s)[r - 1], &after = card.runs_of_strip(s)[r];
  const FacetPlane &p = card.planes()[before.label], &q = card.planes()[after.label];
  std::vector<std::vector<Label>> out;
  if (card.labelling.is_fixed(s)) return out;
  const int length = p.upright ? q.offset - p.offset : p.offset - q.offset;
  if (p.upright != q.upright || length < card.labelling.limits().least_run) return out;
  // Planes are tried a pitch apart, so that one near the cut is there.
  for (const int from : {before.end - length, before.end})
    for (int off = 0; off <= kLedgeReach; ++off) {
      auto labels = with_ledge_at(card, s, r, from + off);
      if (!labels) labels = with_ledge_at(card, s, r, from - off);
      if (!labels) continue;
      out.push_back(std::move(*labels));
      break;
    }
  return out;
}

std::vector<std::vector<Label>> shifted(const LabelCard& card, int s, std::size_t r) {
  std::vector<std::vector<Label>> out;
  if (card.labelling.is_fixed(s)) return out;
  const FacetPlane& plane = card.planes()[card.runs_of_strip(s)[r].label];
  // The nearest planes, and the nearest ones that count as another place in paper.
  const double step_mm = card.grid().step_mm, apart_mm = card.rule.apart_mm;
  const bool in_paper = apart_mm > 0.0;
  const int most = in_paper ? static_cast<int>(kFarthest * apart_mm / step_mm) : kMostShift;
  const int shifts = in_paper ? kPaperShifts : kShifts;
  for (const int way : {-1, 1}) {
    int found = 0;
    double next_mm = 0.0;
    for (int by = way; found < shifts && std::abs(by) <= most; by += way) {
      if (std::abs(by) * step_mm < next_mm) continue;
      const Label label = card.planes().find({plane.upright, plane.offset + by});
      if (label == kNoLabel) continue;
      if (++found >= kShifts) next_mm = std::max(apart_mm, std::abs(by) * step_mm + 0.5 * apart_mm);
      if (auto labels = shifted_to(card, s, r, label, plane.upright ? by : -by))
        out.push_back(std::move(*labels));
    }
  }
  return out;
}

NewStrips painted_over(LabelCard& card, const LoosePatch& patch, bool take_beside) {
  NewStrips out, before;
  for (std::size_t k = 0; k < patch.cells.size();) {
    const int s = patch.cells[k].strip;
    std::vector<Label> labels = labels_of(card.image(), s);
    before.push_back({s, labels});
    for (; k < patch.cells.size() && patch.cells[k].strip == s; ++k)
      labels = painted_over(card, s, patch.cells[k], take_beside, std::move(labels));
    card.labelling.set(s, labels);
    out.push_back({s, std::move(labels)});
  }
  for (const auto& [s, labels] : before) card.labelling.set(s, labels);
  return out;
}

NewStrips without_patch(LabelCard& card, const LoosePatch& patch, bool jumps) {
  NewStrips out, before;
  const std::size_t bans = card.labelling.bans();
  for (const LabelBan& ban : patch.cells) card.labelling.ban(ban);
  for (std::size_t k = 0; k < patch.cells.size(); ++k) {
    const int s = patch.cells[k].strip;
    if (k > 0 && patch.cells[k - 1].strip == s) continue;
    before.push_back({s, labels_of(card.image(), s)});
    out.push_back({s, card.labelling.best(s, jumps)});
    card.labelling.set(s, out.back().labels);
  }
  card.labelling.forget_bans(bans);
  for (const auto& [s, labels] : before) card.labelling.set(s, labels);
  return out;
}

bool is_wide(const std::vector<Label>& labels, int least_run) {
  int run = 0;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (i > 0 && labels[i] != labels[i - 1]) {
      if (run < least_run) return false;
      run = 0;
    }
    ++run;
  }
  return run >= least_run;
}

}  // namespace popcut
