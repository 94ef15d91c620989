// SPDX-License-Identifier: MIT
#include "core/design/facets/facet_repair.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <utility>

#include "core/design/facets/label_holding.hpp"
#include "core/geometry/disjoint_sets.hpp"

namespace popcut {
namespace {

/// New labels for some strips, and what they cost more.
struct Move {
  enum class Kind { Strut, Shift, Drop } kind{};
  std::vector<std::pair<int, std::vector<Label>>> strips;
  double cost{};
};

class Repairer {
 public:
  Repairer(Labelling& labelling, const FacetCardSize& card, double min_panel_mm,
           const RepairOptions& how, const Progress& progress)
      : labelling_(labelling),
        card_(card),
        min_panel_mm_(min_panel_mm),
        how_(how),
        progress_(progress),
        most_tried_(how.rough ? kMostTriedRoughly : kMostTried) {}

  Result<FacetRepair> run() {
    if (how_.jumps) hold_enclosed();
    LabelImage whole = labelling_.image();
    fill_enclosed(whole, planes(), min_panel_mm_);
    take(how_.shifts ? with_worthy(whole) : whole);
    const auto first = pattern_of(whole, planes(), card_, min_panel_mm_);
    if (!first) return tl::unexpected(first.error());
    out_.loose_before = first->motion.degrees_of_freedom - 1;
    tries_.assign(static_cast<std::size_t>(grid().strips), 0);
    const int most = 100 + 4 * grid().strips;
    for (int round = 0; state_.open > 0; ++round) {
      tell(progress_, "making loose panels hold");
      round_ = round;
      if (work_ / 2 > how_.most_work) {
        out_.unfinished = true;
        return std::move(out_);
      }
      if (round > most)
        clear_loose();
      else if (work_ > how_.most_work)
        give_up_smallest();
      else if (!improve())
        give_up_smallest();
    }
    if (!how_.rough) polish();
    if (!how_.rough) keep_real_struts();
    return std::move(out_);
  }

 private:
  [[nodiscard]] const FacetPlanes& planes() const { return labelling_.planes(); }
  [[nodiscard]] const FacetGrid& grid() const { return labelling_.image().grid; }
  [[nodiscard]] int least_run() const { return labelling_.limits().least_run; }
  [[nodiscard]] LabelHolding holding(const LabelImage& image) const {
    return holding_of(image, planes(), min_panel_mm_);
  }

  /// Sets the labels, and with them what is loose.
  void take(const LabelImage& image) {
    for (int s = 0; s < grid().strips; ++s) {
      const auto strip = image.strip(s);
      labelling_.set(s, {strip.begin(), strip.end()});
    }
    runs_ = strip_runs(image, planes());
    state_ = holding_of(runs_, planes(), grid(), min_panel_mm_);
    work_ += state_.patches.runs.size();
  }

  /// The runs of a strip, and whether each is loose.
  [[nodiscard]] std::span<const LabelRun> runs(int s) const {
    const auto at = static_cast<std::size_t>(s) + 1;
    return std::span(state_.patches.runs)
        .subspan(state_.patches.first_run[at],
                 state_.patches.first_run[at + 1] - state_.patches.first_run[at]);
  }
  [[nodiscard]] std::uint32_t patch_of(int s, std::size_t run) const {
    return state_.patches.patch[state_.patches.first_run[static_cast<std::size_t>(s) + 1] + run];
  }
  [[nodiscard]] bool is_loose(int s, std::size_t run) const {
    return state_.loose[patch_of(s, run)] != 0;
  }

  /// What a move costs more than what is there, cuts to strips beside it included.
  double extra_cost(const Move& move) {
    double sum = 0.0;
    std::vector<std::pair<int, std::vector<Label>>> before;
    for (const auto& [strip, labels] : move.strips) {
      const auto old = labelling_.image().strip(strip);
      before.emplace_back(strip, std::vector<Label>(old.begin(), old.end()));
      sum += labelling_.cost(strip, labels) - labelling_.cost(strip, old);
      labelling_.set(strip, labels);
    }
    for (const auto& [strip, labels] : before) labelling_.set(strip, labels);
    return sum;
  }

  [[nodiscard]] std::vector<Label> labels_of(int s) const {
    const auto strip = labelling_.image().strip(s);
    return {strip.begin(), strip.end()};
  }
  static void paint(std::vector<Label>& labels, int begin, int end, Label label) {
    std::fill(labels.begin() + begin, labels.begin() + end, label);
  }

  /// The line where an upright and a level plane meet.
  [[nodiscard]] int fold_of(const FacetPlane& p, const FacetPlane& q) const {
    return grid().wall + (p.upright ? p.offset - q.offset : q.offset - p.offset);
  }

  /// Of a strip, from run a on to run b: all between them go, and they meet in one fold.
  void add_meeting(int s, std::size_t a, std::size_t b, std::vector<Move>& moves) {
    const LabelRun &before = runs(s)[a], &after = runs(s)[b];
    const FacetPlane &p = planes()[before.label], &q = planes()[after.label];
    int fold = before.end;
    if (before.label != after.label) {
      if (p.upright == q.upright) return;
      fold = fold_of(p, q);
      if (fold < before.begin + least_run() || fold > after.end - least_run()) return;
    }
    std::vector<Label> labels = labels_of(s);
    paint(labels, before.begin, fold, before.label);
    paint(labels, fold, after.end, after.label);
    add({Move::Kind::Strut, {{s, std::move(labels)}}}, moves);
  }

  /// Where two runs meet in a cut: a panel between them that meets both in folds.
  void add_ledge(int s, std::size_t r, std::vector<Move>& moves) {
    const LabelRun &before = runs(s)[r - 1], &after = runs(s)[r];
    const FacetPlane &p = planes()[before.label], &q = planes()[after.label];
    if (p.upright != q.upright) return;
    const int length = p.upright ? q.offset - p.offset : p.offset - q.offset;
    if (length < least_run()) return;
    // Before the cut and after it; planes are tried a pitch apart, so that one near it is there.
    for (const int from : {before.end - length, before.end})
      for (int off = 0; off <= kLedgeReach; ++off)
        if (add_ledge_at(s, r, from + off, moves) || add_ledge_at(s, r, from - off, moves)) break;
  }

  bool add_ledge_at(int s, std::size_t r, int line, std::vector<Move>& moves) {
    const LabelRun &before = runs(s)[r - 1], &after = runs(s)[r];
    const FacetPlane &p = planes()[before.label], &q = planes()[after.label];
    const int across = grid().across(line);
    const FacetPlane ledge{!p.upright, p.upright ? p.offset - across : p.offset + across};
    const Label label = planes().find(ledge);
    if (label == kNoLabel) return false;
    const int end = fold_of(ledge, q);
    if (line < before.begin + least_run() || end < line + least_run() ||
        end > after.end - least_run())
      return false;
    std::vector<Label> labels = labels_of(s);
    paint(labels, before.begin, line, before.label);
    paint(labels, line, end, label);
    paint(labels, end, after.end, after.label);
    add({Move::Kind::Strut, {{s, std::move(labels)}}}, moves);
    return true;
  }

  /// Struts in the strips of loose runs.
  void add_struts(std::vector<Move>& moves) {
    for (int s = 0; s < grid().strips; ++s) {
      const std::span<const LabelRun> here = runs(s);
      const auto any_loose = [&](std::size_t from, std::size_t to) {
        for (std::size_t r = from; r <= to; ++r)
          if (is_loose(s, r)) return true;
        return false;
      };
      if (is_worn(s) || !any_loose(0, here.size() - 1)) continue;
      bool cuts = false;
      for (std::size_t r = 1; r < here.size(); ++r) {
        if (!here[r].folds_on) {
          cuts = true;
          if (any_loose(r - 1, r)) {
            add_meeting(s, r - 1, r, moves);
            add_ledge(s, r, moves);
          }
        }
        if (r + 1 < here.size() && any_loose(r - 1, r + 1)) add_meeting(s, r - 1, r + 1, moves);
        if (r + 2 < here.size() && any_loose(r - 1, r + 2)) add_meeting(s, r - 1, r + 2, moves);
      }
      if (cuts) add({Move::Kind::Strut, {{s, labelling_.best(s, false)}}}, moves);
      if (how_.shifts && round_ < kShiftRounds)
        for (std::size_t r = 1; r + 1 < here.size(); ++r)
          if (any_loose(r - 1, r + 1)) add_shifts(s, r, moves);
    }
  }

  /// A panel in a plane beside its own, in one strip: where the panels that it meets go on in the
  /// strips beside it, they meet planes at two places, which hold them, as in a lattice.
  void add_shifts(int s, std::size_t r, std::vector<Move>& moves) {
    const FacetPlane& plane = planes()[runs(s)[r].label];
    for (const int way : {-1, 1}) {
      int found = 0;
      for (int by = way; found < 2 && std::abs(by) <= kMostShift; by += way) {
        const Label label = planes().find({plane.upright, plane.offset + by});
        if (label == kNoLabel) continue;
        ++found;
        add_shift(s, r, label, plane.upright ? by : -by, moves);
      }
    }
  }

  void add_shift(int s, std::size_t r, Label label, int shift, std::vector<Move>& moves) {
    LabelRun before = runs(s)[r - 1], run = runs(s)[r], after = runs(s)[r + 1];
    if (label == before.label || label == after.label) return;
    run.label = label;
    if (run.folds_on) run.begin = before.end = run.begin + shift;
    if (after.folds_on) run.end = after.begin = run.end + shift;
    if (!labelling_.allows(before) || !labelling_.allows(run) || !labelling_.allows(after)) return;
    std::vector<Label> labels = labels_of(s);
    for (const LabelRun& one : {before, run, after}) paint(labels, one.begin, one.end, one.label);
    add({Move::Kind::Shift, {{s, std::move(labels)}}}, moves);
  }

  void add(Move move, std::vector<Move>& moves) {
    if (std::any_of(move.strips.begin(), move.strips.end(),
                    [&](const auto& one) { return was_given_up(one.first, one.second); }))
      return;
    move.cost = extra_cost(move);
    moves.push_back(std::move(move));
  }

  /// What wall or ground enclose gets a strip that goes on from it to both, where that costs less
  /// than to do without it: a bridge to one of them would still leave a hole in that face.
  void hold_enclosed() {
    for (int round = 0; round < kMostBridges; ++round) {
      LabelImage filled = labelling_.image();
      if (!fill_enclosed(filled, planes(), min_panel_mm_)) return;
      const std::vector<Floating> all = enclosed(filled, true);
      bool any = false;
      for (const Floating& one : all) {
        const std::optional<Move> move = bridge(one, filled);
        if (!move) continue;
        const auto& [s, labels] = move->strips.front();
        out_.struts.push_back({s, labels_of(s)});
        labelling_.set(s, labels);
        any = true;
      }
      if (!any) return;
    }
  }

  /// Stretches of strips, by strip, that hang together and that other patches enclose.
  struct Floating {
    struct Stretch {
      int strip{}, begin{}, end{};
    };
    std::vector<Stretch> stretches;
  };

  /// The labels without what is enclosed, but with that which is worth a strut.
  [[nodiscard]] LabelImage with_worthy(const LabelImage& filled) {
    LabelImage out = filled;
    for (const Floating& one : enclosed(filled, false))
      if (is_worth_a_strut(one, filled))
        for (const Floating::Stretch& stretch : one.stretches) {
          const auto now = std::as_const(labelling_).image().strip(stretch.strip);
          std::copy(now.begin() + stretch.begin, now.begin() + stretch.end,
                    out.strip(stretch.strip).begin() + stretch.begin);
        }
    return out;
  }

  /// Whether to do without what other paper encloses costs far more than a strut for it, which cuts
  /// that paper: a window in it shows the card, and of most letters no more is there.
  [[nodiscard]] bool is_worth_a_strut(const Floating& one, const LabelImage& filled) {
    double loss = 0.0, strut = std::numeric_limits<double>::infinity();
    bool any = false;
    for (std::size_t k = 0; k < one.stretches.size();) {
      const int s = one.stretches[k].strip;
      const std::vector<Label> now = labels_of(s);
      const auto then = filled.strip(s);
      std::vector<Label> paper = now, open = now;
      for (; k < one.stretches.size() && one.stretches[k].strip == s; ++k)
        for (int i = one.stretches[k].begin; i < one.stretches[k].end; ++i) {
          const auto at = static_cast<std::size_t>(i);
          paper[at] = then[at], open[at] = i < grid().wall ? kWallLabel : kGroundLabel;
          any = any || (now[at] != kWallLabel && now[at] != kGroundLabel);
        }
      loss += std::min(labelling_.distance(s, paper), labelling_.distance(s, open)) -
              labelling_.distance(s, now);
      strut =
          std::min(strut, labelling_.cost(s, labelling_.best(s, false)) - labelling_.cost(s, now));
    }
    return any && loss > kWorthStrut * strut;
  }

  /// @param filled   the labels without what is enclosed
  /// @param by_card  by wall or ground; false: by other paper
  [[nodiscard]] std::vector<Floating> enclosed(const LabelImage& filled, bool by_card) const {
    std::vector<Floating::Stretch> all;
    for (int s = 0; s < grid().strips; ++s) {
      const auto now = labelling_.image().strip(s), then = filled.strip(s);
      const auto is_free = [&](int i) {
        const auto at = static_cast<std::size_t>(i);
        return now[at] != then[at] &&
               (then[at] == kWallLabel || then[at] == kGroundLabel) == by_card;
      };
      for (int i = 0; i < grid().columns; ++i) {
        if (!is_free(i)) continue;
        const int begin = i;
        while (i < grid().columns && is_free(i)) ++i;
        all.push_back({s, begin, i});
      }
    }
    DisjointSets sets(all.size());
    for (std::uint32_t a = 0; a < all.size(); ++a)
      for (std::uint32_t b = a + 1; b < all.size() && all[b].strip <= all[a].strip + 1; ++b)
        if (all[b].strip == all[a].strip + 1 && all[a].begin < all[b].end &&
            all[b].begin < all[a].end)
          sets.join(a, b);
    std::vector<std::uint32_t> number;
    std::vector<Floating> out(sets.number(number));
    for (std::size_t k = 0; k < all.size(); ++k) out[number[k]].stretches.push_back(all[k]);
    return out;
  }

  /// The strip of something enclosed that costs least to go on to wall and ground; none where
  /// leaving it out costs less.
  [[nodiscard]] std::optional<Move> bridge(const Floating& one, const LabelImage& filled) {
    Move without{Move::Kind::Drop, {}};
    for (const Floating::Stretch& stretch : one.stretches) {
      if (without.strips.empty() || without.strips.back().first != stretch.strip)
        without.strips.emplace_back(stretch.strip, labels_of(stretch.strip));
      const auto then = filled.strip(stretch.strip);
      std::copy(then.begin() + stretch.begin, then.begin() + stretch.end,
                without.strips.back().second.begin() + stretch.begin);
    }
    const double most = extra_cost(without);
    double least = 0.0;
    std::optional<Move> best;
    // A strip in the middle carries better than one at the side.
    const int first = one.stretches.front().strip, last = one.stretches.back().strip;
    for (const Floating::Stretch& stretch : one.stretches) {
      std::vector<Label> labels = labels_of(stretch.strip);
      if (!go_on_to_wall(stretch, labels) || !go_on_to_ground(stretch, labels)) continue;
      if (!is_wide(labels)) continue;
      Move move{Move::Kind::Strut, {{stretch.strip, std::move(labels)}}};
      const double cost = extra_cost(move);
      const double aside = std::abs(2 * stretch.strip - first - last) /
                           std::max(1.0, static_cast<double>(last - first));
      const double price = cost + kAside * aside * std::abs(cost);
      if (cost < most && (!best || price < least)) least = price, best = std::move(move);
    }
    return best;
  }

  /// A level plane reaches from a stretch back to the wall: its first one, or one that meets the
  /// first in a fold. False: none does.
  [[nodiscard]] bool go_on_to_wall(const Floating::Stretch& stretch,
                                   std::vector<Label>& labels) const {
    const Label first = labels[static_cast<std::size_t>(stretch.begin)];
    for (int off = 0; off <= kLedgeReach && stretch.begin + off < stretch.end; ++off) {
      const int line = stretch.begin + off;
      if (labels[static_cast<std::size_t>(line)] != first) return false;
      const Label level =
          planes()[first].upright ? planes().partner(first, grid().across(line)) : first;
      if (level == kNoLabel || level == kGroundLabel) continue;
      const int wall = grid().wall - planes()[level].offset;
      if (wall < 1 || wall >= line || labels[static_cast<std::size_t>(wall - 1)] != kWallLabel)
        continue;
      paint(labels, wall, line, level);
      return true;
    }
    return false;
  }

  /// An upright plane reaches from a stretch down to the ground, likewise.
  [[nodiscard]] bool go_on_to_ground(const Floating::Stretch& stretch,
                                     std::vector<Label>& labels) const {
    const Label last = labels[static_cast<std::size_t>(stretch.end - 1)];
    for (int off = 0; off <= kLedgeReach && stretch.end - off > stretch.begin; ++off) {
      const int line = stretch.end - off;
      if (labels[static_cast<std::size_t>(line - 1)] != last) return false;
      const Label upright =
          planes()[last].upright ? last : planes().partner(last, grid().across(line));
      if (upright == kNoLabel || upright == kWallLabel) continue;
      const int ground = grid().wall + planes()[upright].offset;
      if (ground <= line || ground >= grid().columns ||
          labels[static_cast<std::size_t>(ground)] != kGroundLabel)
        continue;
      paint(labels, line, ground, upright);
      return true;
    }
    return false;
  }

  struct LoosePatch {
    double area{};
    std::vector<LabelBan> cells;
  };
  /// The loose patches, smallest first.
  [[nodiscard]] std::vector<LoosePatch> loose_patches() const {
    std::map<std::uint32_t, LoosePatch> by_patch;
    for (int s = 0; s < grid().strips; ++s)
      for (std::size_t r = 0; r < runs(s).size(); ++r) {
        if (!is_loose(s, r)) continue;
        const LabelRun& run = runs(s)[r];
        LoosePatch& patch = by_patch[patch_of(s, r)];
        patch.area += run.end - run.begin;
        patch.cells.push_back({s, run.begin, run.end, run.label});
      }
    std::vector<LoosePatch> out;
    for (auto& [number, patch] : by_patch) out.push_back(std::move(patch));
    std::stable_sort(out.begin(), out.end(),
                     [](const LoosePatch& a, const LoosePatch& b) { return a.area < b.area; });
    return out;
  }

  /// The strips of a patch with other labels just there: those of the runs before and after it, up
  /// to where these meet if that is inside, or those of a strip beside it; whichever costs least.
  [[nodiscard]] Move painted_over(const LoosePatch& patch, bool beside) {
    Move move{Move::Kind::Drop, {}};
    std::vector<std::pair<int, std::vector<Label>>> before;
    for (std::size_t k = 0; k < patch.cells.size();) {
      const int s = patch.cells[k].strip;
      std::vector<Label> labels = labels_of(s);
      before.emplace_back(s, labels);
      for (; k < patch.cells.size() && patch.cells[k].strip == s; ++k)
        paint_over(s, patch.cells[k], beside, labels);
      labelling_.set(s, labels);
      move.strips.emplace_back(s, std::move(labels));
    }
    for (const auto& [s, labels] : before) labelling_.set(s, labels);
    return move;
  }

  void paint_over(int s, const LabelBan& cell, bool take_beside, std::vector<Label>& labels) {
    const auto at = [&](int column) { return labels[static_cast<std::size_t>(column)]; };
    const Label first = cell.begin > 0 ? at(cell.begin - 1) : kWallLabel,
                last = cell.end < grid().columns ? at(cell.end) : kGroundLabel;
    std::vector<Label> best;
    double least = 0.0;
    const auto look = [&](std::vector<Label> other) {
      const double cost = labelling_.cost(s, other);
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
    const FacetPlane &p = planes()[first], &q = planes()[last];
    if (p.upright != q.upright) {
      const int fold = fold_of(p, q);
      if (fold > cell.begin && fold < cell.end) split_at(fold);
    }
    for (const int beside : {s - 1, s + 1}) {
      if (!take_beside || beside < 0 || beside >= grid().strips) continue;
      std::vector<Label> other = labels;
      const auto strip = labelling_.image().strip(beside);
      std::copy(strip.begin() + cell.begin, strip.begin() + cell.end, other.begin() + cell.begin);
      if (std::find(other.begin() + cell.begin, other.begin() + cell.end, cell.label) ==
              other.begin() + cell.end &&
          is_wide(other))
        look(std::move(other));
    }
    if (!best.empty()) labels = std::move(best);
  }

  /// Whether all runs are long enough.
  [[nodiscard]] bool is_wide(const std::vector<Label>& labels) const {
    int run = 0;
    for (std::size_t i = 0; i < labels.size(); ++i) {
      if (i > 0 && labels[i] != labels[i - 1]) {
        if (run < least_run()) return false;
        run = 0;
      }
      ++run;
    }
    return run >= least_run();
  }

  /// The strips of a patch without its label there, each beside the new ones before it.
  [[nodiscard]] Move dropped(const LoosePatch& patch) {
    Move move{Move::Kind::Drop, {}};
    std::vector<std::pair<int, std::vector<Label>>> before;
    const std::size_t bans = labelling_.bans();
    for (const LabelBan& ban : patch.cells) labelling_.ban(ban);
    for (std::size_t k = 0; k < patch.cells.size(); ++k) {
      const int s = patch.cells[k].strip;
      if (k > 0 && patch.cells[k - 1].strip == s) continue;
      before.emplace_back(s, labels_of(s));
      move.strips.emplace_back(s, labelling_.best(s, how_.jumps));
      labelling_.set(s, move.strips.back().second);
    }
    labelling_.forget_bans(bans);
    for (const auto& [s, labels] : before) labelling_.set(s, labels);
    return move;
  }

  [[nodiscard]] LabelImage after(const Move& move) const {
    LabelImage image = labelling_.image();
    for (const auto& [s, labels] : move.strips)
      std::copy(labels.begin(), labels.end(), image.strip(s).begin());
    return image;
  }

  /// What a move costs more together with what wall or ground then enclose, which goes. What other
  /// paper encloses is not counted: a window shows it.
  double cost_with_losses(const Move& move, const LabelImage& settled) {
    LabelImage image = labelling_.image();
    for (const auto& [s, labels] : move.strips)
      std::copy(labels.begin(), labels.end(), image.strip(s).begin());
    Move whole{move.kind, {}};
    for (int s = 0; s < grid().strips; ++s) {
      std::vector<Label> labels(image.strip(s).begin(), image.strip(s).end());
      const auto then = settled.strip(s), now = std::as_const(labelling_).image().strip(s);
      for (std::size_t i = 0; i < labels.size(); ++i)
        if (then[i] == kWallLabel || then[i] == kGroundLabel) labels[i] = then[i];
      if (!std::equal(now.begin(), now.end(), labels.begin()))
        whole.strips.emplace_back(s, std::move(labels));
    }
    return extra_cost(whole);
  }

  /// How loose labels are: the pins that would hold them, and a little for all that these move.
  static double looseness(const LabelHolding& holding) {
    constexpr double kOpen = 0.03;
    return holding.pins + kOpen * static_cast<double>(holding.open);
  }

  /// Looseness after a move: done in place, since there are many.
  [[nodiscard]] double looseness_after(const Move& move) {
    std::vector<std::pair<std::size_t, std::vector<LabelRun>>> before;
    for (const auto& [s, labels] : move.strips) {
      const auto at = static_cast<std::size_t>(s) + 1;
      before.emplace_back(at, std::move(runs_[at]));
      runs_[at] = runs_of(labels, planes(), grid());
    }
    const LabelHolding then = holding_of(runs_, planes(), grid(), min_panel_mm_);
    work_ += then.patches.runs.size();
    const double loose = looseness(then);
    for (auto& [at, runs] : before) runs_[at] = std::move(runs);
    return loose;
  }

  /// Makes the moves that cost least for what they hold. Whether any was made.
  bool improve() {
    std::vector<Move> moves;
    add_struts(moves);
    const std::vector<LoosePatch> loose = loose_patches();
    for (std::size_t k = 0; k < loose.size() && k < kMostPaintings; ++k) {
      if (how_.jumps) add(painted_over(loose[k], true), moves);
      if (k < kMostDrops && !is_worn(loose[k].cells.front().strip)) add(dropped(loose[k]), moves);
    }
    std::sort(moves.begin(), moves.end(),
              [](const Move& a, const Move& b) { return a.cost < b.cost; });
    // Cheap ones first: what costs so much that it would have to hold far more than any yet is not
    // looked at.
    std::vector<std::pair<double, const Move*>> good;
    double least_price = std::numeric_limits<double>::infinity(), most_held = 1.0;
    for (std::size_t k = 0; k < moves.size(); ++k) {
      const Move& move = moves[k];
      if (k >= most_tried_ && (!good.empty() || k >= kOnUntilOne * most_tried_)) break;
      if (move.cost > (kDearer * least_price + 1e-6) * kHoldsMore * most_held) break;
      const double held = looseness(state_) - looseness_after(move);
      if (held <= kLeastHeld) continue;
      const double price = std::max(0.0, move.cost) / held;
      good.emplace_back(price, &move);
      least_price = std::min(least_price, price), most_held = std::max(most_held, held);
    }
    if (good.empty()) return false;
    std::stable_sort(good.begin(), good.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    const double dearest =
        std::max(kDearer * good.front().first, good[good.size() / kMadeOf].first) + 1e-6;
    bool any = false;
    std::vector<std::uint8_t> touched(static_cast<std::size_t>(grid().strips), 0);
    for (const auto& [price, move] : good) {
      if (price > dearest || state_.open == 0) break;
      if (std::any_of(move->strips.begin(), move->strips.end(), [&](const auto& one) {
            return touched[static_cast<std::size_t>(one.first)] != 0;
          }))
        continue;
      if (!accept(*move, dearest)) continue;
      any = true;
      for (const auto& one : move->strips) touched[static_cast<std::size_t>(one.first)] = 1;
    }
    return any;
  }

  /// Makes a move if it still holds enough for what it costs.
  bool accept(const Move& move, double dearest) {
    const LabelImage image = after(move);
    const LabelHolding then = holding(image);
    const double held = looseness(state_) - looseness(then);
    if (held <= kLeastHeld || cost_with_losses(move, image) > dearest * held) return false;
    if (move.kind == Move::Kind::Shift) ++out_.shifted;
    if (move.kind != Move::Kind::Drop)
      for (const auto& one : move.strips) out_.struts.push_back({one.first, labels_of(one.first)});
    else
      ++out_.dropped;
    for (const auto& one : move.strips) ++tries_[static_cast<std::size_t>(one.first)];
    take(image);
    return true;
  }

  /// Whether a strip was changed so often that it is not to be again, but for giving patches up.
  [[nodiscard]] bool is_worn(int s) const {
    return tries_[static_cast<std::size_t>(s)] > kMostTries;
  }

  /// The smallest loose patch goes: the runs before or after it take its place, so that there are
  /// fewer runs each time. Without jumps its label is not taken again.
  void give_up_smallest() {
    const std::vector<LoosePatch> loose = loose_patches();
    if (loose.empty()) return clear_loose();
    for (const LabelBan& cell : loose.front().cells)
      given_up_.emplace(cell.strip, labels_of(cell.strip));
    if (how_.jumps) {
      take(after(painted_over(loose.front(), false)));
    } else {
      for (const LabelBan& ban : loose.front().cells)
        if (ban.label != kWallLabel && ban.label != kGroundLabel) labelling_.ban(ban);
      take(after(dropped(loose.front())));
    }
    ++out_.dropped;
  }

  /// Whether a strip had these labels when a patch of it was given up: it does not get them back.
  [[nodiscard]] bool was_given_up(int s, const std::vector<Label>& labels) const {
    return given_up_.contains({s, labels});
  }

  /// Plain card in the strips that have anything loose; in all of them where none has.
  void clear_loose() {
    LabelImage image = labelling_.image();
    bool any = false;
    for (const bool all : {false, true}) {
      for (int s = 0; s < grid().strips; ++s) {
        bool loose = all;
        for (std::size_t r = 0; r < runs(s).size() && !loose; ++r) loose = is_loose(s, r);
        if (!loose || runs(s).size() == 2) continue;
        any = true;
        const auto strip = image.strip(s);
        std::fill(strip.begin(), strip.begin() + grid().wall, kWallLabel);
        std::fill(strip.begin() + grid().wall, strip.end(), kGroundLabel);
      }
      if (any) break;
    }
    ++out_.dropped;
    fill_enclosed(image, planes(), min_panel_mm_);
    take(image);
  }

  /// Strips that can come nearer to the target without loosening anything.
  void polish() {
    constexpr int kRounds = 3;
    for (int round = 0; round < kRounds; ++round) {
      bool any = false;
      for (int s = 0; s < grid().strips; ++s)
        for (const bool jumps : {true, false}) {
          if (jumps && !how_.jumps) continue;
          Move move{Move::Kind::Drop, {{s, labelling_.best(s, jumps)}}};
          if (extra_cost(move) >= -1e-6) continue;
          const LabelImage image = after(move);
          if (holding(image).open > 0 || cost_with_losses(move, image) >= -1e-6) continue;
          take(image);
          any = true;
          break;
        }
      if (!any) break;
    }
  }

  /// Of the struts those without which the card would be loose, as it now is; those without which
  /// something would fall out are counted.
  void keep_real_struts() {
    std::erase_if(out_.struts, [&](const FacetStrut& strut) {
      LabelImage image = labelling_.image();
      std::copy(strut.without.begin(), strut.without.end(), image.strip(strut.strip).begin());
      LabelImage filled = image;
      if (fill_enclosed(filled, planes(), min_panel_mm_)) {
        ++(falls_into_card(image, filled) ? out_.bridges : out_.inner);
        return true;
      }
      const auto made = pattern_of(image, planes(), card_, min_panel_mm_);
      return !made || made->motion.degrees_of_freedom == 1;
    });
  }

  /// Whether wall or ground takes the place of something.
  static bool falls_into_card(const LabelImage& image, const LabelImage& filled) {
    for (std::size_t k = 0; k < image.label.size(); ++k)
      if (filled.label[k] != image.label[k] &&
          (filled.label[k] == kWallLabel || filled.label[k] == kGroundLabel))
        return true;
    return false;
  }

  static constexpr std::size_t kMostDrops = 8, kMostPaintings = 60, kMostTried = 600,
                               kMostTriedRoughly = 150;
  static constexpr int kMostTries = 8, kLedgeReach = 8, kMostShift = 8, kShiftRounds = 14,
                       kMostBridges = 4;
  static constexpr double kWorthStrut = 4.0;  ///< times the estimated cost of a strut
  static constexpr double kAside = 0.2;       ///< of its cost, what a strip at the side costs more
  static constexpr double kLeastHeld = 0.05;  ///< less is rounding
  static constexpr double kDearer = 2.0;      ///< than the best move of a round
  static constexpr std::size_t kMadeOf = 8;   ///< a round makes one of so many good moves
  static constexpr std::size_t kOnUntilOne = 10;  ///< times `kMostTried`, where none of those holds
  static constexpr double kHoldsMore = 2.0;       ///< than any move of the round that was looked at

  Labelling& labelling_;
  FacetCardSize card_;
  double min_panel_mm_;
  RepairOptions how_;
  const Progress& progress_;
  StripRuns runs_;  ///< with a strip of card before and after
  LabelHolding state_;
  FacetRepair out_;
  std::vector<int> tries_;  ///< changes of each strip
  std::set<std::pair<int, std::vector<Label>>> given_up_;
  int round_{};
  std::size_t most_tried_, work_{};
};

}  // namespace

Result<FacetRepair> repair(Labelling& labelling, const FacetCardSize& card, double min_panel_mm,
                           const RepairOptions& how, const Progress& progress) {
  return Repairer(labelling, card, min_panel_mm, how, progress).run();
}

}  // namespace popcut
