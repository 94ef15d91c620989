// SPDX-License-Identifier: MIT
#include "core/design/facets/patch_moves.hpp"

#include <algorithm>
#include <cmath>
#include <compare>
#include <cstdint>
#include <set>
#include <utility>
#include <vector>

#include "core/design/facets/label_card.hpp"
#include "core/design/facets/strip_moves.hpp"

namespace popcut {
namespace {

class PatchMover {
 public:
  PatchMover(Labelling& labelling, const HoldRule& rule, double min_fold_mm, std::size_t most_work)
      : card_(labelling, rule),
        stale_(static_cast<std::size_t>(card_.grid().strips), 1),
        min_fold_mm_(min_fold_mm),
        most_work_(most_work) {}

  std::size_t run() {
    constexpr int kRounds = 3;
    for (int round = 0; round < kRounds; ++round) {
      const std::size_t before = moved_;
      solve_strips();
      move_all();
      if (counts_hinges()) remove_patches();
      if (min_fold_mm_ > card_.grid().strip_mm) lengthen_creases();
      if (moved_ == before) break;
    }
    return moved_;
  }

 private:
  /// Where a patch is found again when others have moved.
  struct Place {
    int strip{-1}, column{};
  };

  [[nodiscard]] const FacetPlanes& planes() const { return card_.planes(); }
  [[nodiscard]] const FacetGrid& grid() const { return card_.grid(); }
  [[nodiscard]] const LabelPatches& patches() const { return card_.holding.patches; }
  [[nodiscard]] bool is_over() const { return work_ > most_work_; }

  /// A place in each patch that is neither in the wall nor in the ground.
  [[nodiscard]] std::vector<Place> places() const {
    std::vector<Place> out(patches().count);
    for (int s = 0; s < grid().strips; ++s)
      for (std::uint32_t r = card_.first_run(s); r < card_.first_run(s + 1); ++r) {
        Place& place = out[patches().patch[r]];
        if (place.strip < 0 && planes()[patches().runs[r].label].offset != 0)
          place = {s, patches().runs[r].begin};
      }
    std::erase_if(out, [](const Place& place) { return place.strip < 0; });
    return out;
  }
  [[nodiscard]] std::uint32_t patch_at(const Place& place) const {
    std::uint32_t r = card_.first_run(place.strip);
    while (patches().runs[r].end <= place.column) ++r;
    return patches().patch[r];
  }

  void move_all() {
    for (const Place& place : places()) {
      if (is_over()) return;
      const std::uint32_t patch = patch_at(place);
      NewStrips best;
      double least = -kLeastGain;
      std::vector<int> shifts{-1, 1, -2, 2, -4, 4};
      if (counts_hinges()) add_neighbours(patch, shifts);
      for (const int by : shifts) {
        NewStrips strips = moved(patch, by);
        if (strips.empty()) continue;
        const double extra = extra_cost(card_.labelling, strips);
        if (extra < least) least = extra, best = std::move(strips);
      }
      if (!best.empty()) accept(best);
    }
  }

  [[nodiscard]] bool counts_hinges() const { return card_.labelling.weights().hinge_mm3 > 0.0; }

  /// How far a patch is from the planes of those beside it, which it could become one with.
  void add_neighbours(std::uint32_t patch, std::vector<int>& shifts) const {
    const std::size_t usual = shifts.size();
    for (int s = 0; s < grid().strips; ++s)
      for (std::uint32_t r = card_.first_run(s); r < card_.first_run(s + 1); ++r) {
        if (patches().patch[r] != patch) continue;
        const LabelRun& run = patches().runs[r];
        const FacetPlane& plane = planes()[run.label];
        for (const int other : {s - 1, s + 1}) {
          if (other < 0 || other >= grid().strips) continue;
          for (const LabelRun& beside : card_.runs_of_strip(other)) {
            const FacetPlane& to = planes()[beside.label];
            const int by = to.offset - plane.offset;
            if (beside.end > run.begin && beside.begin < run.end && to.kite < 0 && by != 0 &&
                to.upright == plane.upright &&
                std::find(shifts.begin(), shifts.end(), by) == shifts.end())
              shifts.push_back(by);
          }
        }
        if (shifts.size() > usual + kMostNeighbours) return;
      }
  }

  /// Patches whose hinges cost more than they bring nearer: those before and behind them, or beside
  /// them, take their place.
  void remove_patches() {
    auto cells = patch_cells(card_, false);
    for (const Place& place : places()) {
      if (is_over()) return;
      const auto patch = cells.find(patch_at(place));
      if (patch == cells.end()) continue;
      for (const bool take_beside : {false, true}) {
        if (!take_if_better(painted_over(card_, patch->second, take_beside))) continue;
        cells = patch_cells(card_, false);
        break;
      }
    }
  }

  /// Folds of strips side by side on one line and of one sense, shorter than the shortest fold.
  struct ShortCrease {
    int first{}, last{};  ///< strips
    int column{};
    friend auto operator<=>(const ShortCrease&, const ShortCrease&) = default;
  };
  [[nodiscard]] std::vector<ShortCrease> short_creases() const {
    const FacetGrid& g = grid();
    std::vector<ShortCrease> out;
    // Where the crease of each line and sense began; -1: there is none.
    std::vector<int> begun(2 * static_cast<std::size_t>(g.columns), -1);
    std::vector<std::uint8_t> here(begun.size());
    for (int s = 0; s <= g.strips; ++s) {
      std::fill(here.begin(), here.end(), std::uint8_t{0});
      for (std::size_t i = 1; s < g.strips && i < static_cast<std::size_t>(g.columns); ++i) {
        const Label before = card_.image().strip(s)[i - 1], after = card_.image().strip(s)[i];
        if (before != after && planes().meet(before, after, g.across(static_cast<int>(i))))
          here[2 * i + (planes()[after].upright ? 1 : 0)] = 1;
      }
      for (std::size_t k = 0; k < begun.size(); ++k) {
        if (here[k] != 0 && begun[k] < 0) begun[k] = s;
        if (here[k] != 0 || begun[k] < 0) continue;
        const int first = std::exchange(begun[k], -1), column = static_cast<int>(k / 2);
        // Beside the strips the spine goes on.
        const bool goes_on = column == g.wall && k % 2 == 0 && (first == 0 || s == g.strips);
        if (!goes_on && missing_mm({first, s - 1, column}) > 0.0)
          out.push_back({first, s - 1, column});
      }
    }
    return out;
  }
  [[nodiscard]] double missing_mm(const ShortCrease& crease) const {
    return min_fold_mm_ - (crease.last - crease.first + 1) * grid().strip_mm - kLeastGain;
  }
  /// What creases are too short, all together, mm.
  [[nodiscard]] double missing_mm() const {
    double sum = 0.0;
    for (const ShortCrease& crease : short_creases()) sum += missing_mm(crease);
    return sum;
  }
  [[nodiscard]] double missing_with(const NewStrips& strips) {
    NewStrips before;
    for (const auto& [s, labels] : strips) {
      before.push_back({s, labels_of(card_.image(), s)});
      card_.labelling.set(s, labels);
    }
    const double missing = missing_mm();
    for (const auto& [s, labels] : before) card_.labelling.set(s, labels);
    work_ += patches().runs.size() / 4;
    return missing;
  }

  /// Strip `to` as strip `from`, from the crease on both ways up to where they are the same.
  [[nodiscard]] NewStrip copied(int from, int to, int column) const {
    const auto source = card_.image().strip(from);
    NewStrip out{to, labels_of(card_.image(), to)};
    const auto differ = [&](int i) {
      return source[static_cast<std::size_t>(i)] != out.labels[static_cast<std::size_t>(i)];
    };
    int begin = column, end = column;
    while (begin > 0 && differ(begin - 1)) --begin;
    while (end < grid().columns && differ(end)) ++end;
    std::copy(source.begin() + begin, source.begin() + end, out.labels.begin() + begin);
    return out;
  }
  [[nodiscard]] bool can_be(const NewStrips& strips) const {
    return std::none_of(strips.begin(), strips.end(), [&](const NewStrip& strip) {
      return card_.labelling.is_fixed(strip.strip) || !is_sound(strip.labels);
    });
  }
  /// What makes a crease longer: its strips' panels in those beside them; or takes it away: what is
  /// beside it in its strips.
  [[nodiscard]] std::vector<NewStrips> without(const ShortCrease& crease) const {
    std::vector<NewStrips> out;
    const int more = static_cast<int>(std::ceil(missing_mm(crease) / grid().strip_mm));
    // A long fold in narrow strips has hundreds of ways to be divided; nearby ones are alike.
    const int step = std::max(1, more / kMostWays);
    for (int before = 0; before <= more; before += step) {
      const int after = more - before;
      if (crease.first - before < 0 || crease.last + after >= grid().strips) continue;
      NewStrips strips;
      for (int k = 1; k <= before; ++k)
        strips.push_back(copied(crease.first, crease.first - k, crease.column));
      for (int k = 1; k <= after; ++k)
        strips.push_back(copied(crease.last, crease.last + k, crease.column));
      out.push_back(std::move(strips));
    }
    for (const int beside : {crease.first - 1, crease.last + 1}) {
      if (beside < 0 || beside >= grid().strips) continue;
      NewStrips strips;
      for (int s = crease.first; s <= crease.last; ++s)
        strips.push_back(copied(beside, s, crease.column));
      out.push_back(std::move(strips));
    }
    std::erase_if(out, [&](const NewStrips& strips) { return !can_be(strips); });
    return out;
  }

  /// Short creases become longer or go: by whichever costs least of what leaves fewer mm to be
  /// added and still holds.
  void lengthen_creases() {
    std::set<ShortCrease> seen;
    for (std::vector<ShortCrease> creases = short_creases(); !creases.empty() && !is_over();) {
      const ShortCrease crease = creases.back();
      creases.pop_back();
      if (!seen.insert(crease).second) continue;
      const double missing = missing_mm();
      std::vector<std::pair<double, NewStrips>> choices;
      for (NewStrips& strips : without(crease))
        if (missing_with(strips) < missing - kLeastGain)
          choices.emplace_back(extra_cost(card_.labelling, strips), std::move(strips));
      std::stable_sort(choices.begin(), choices.end(),
                       [](const auto& a, const auto& b) { return a.first < b.first; });
      keeps_folds_ = false;
      if (std::any_of(choices.begin(), choices.end(),
                      [&](const auto& choice) { return accept(choice.second); }))
        creases = short_creases();
    }
    keeps_folds_ = true;
  }

  /// Strips that come nearer without loosening anything. Those that nothing changed beside are as
  /// they were.
  void solve_strips() {
    for (int s = 0; s < grid().strips; ++s) {
      if (is_over()) return;
      if (std::exchange(stale_[static_cast<std::size_t>(s)], std::uint8_t{0}) == 0) continue;
      const std::vector<Label> best = card_.labelling.best(s, true);
      if (!take_if_better({{s, best}})) take_stretches(s, best);
    }
  }

  bool take_if_better(const NewStrips& strips) {
    return extra_cost(card_.labelling, strips) < -kLeastGain && accept(strips);
  }

  /// The stretches in which `best` differs from a strip, one by one.
  void take_stretches(int s, const std::vector<Label>& best) {
    std::vector<Label> now = labels_of(card_.image(), s);
    for (auto from = now.begin(); from != now.end();) {
      const auto [first, other] =
          std::mismatch(from, now.end(), best.begin() + (from - now.begin()));
      if (first == now.end()) return;
      auto last = other;
      from = first;
      while (from != now.end() && *from != *last) ++from, ++last;
      std::vector<Label> changed = now;
      std::copy(other, last, changed.begin() + (first - now.begin()));
      if (!is_sound(changed) || !take_if_better({{s, changed}})) continue;
      std::copy(other, last, first);
    }
  }

  [[nodiscard]] bool is_sound(const std::vector<Label>& labels) const {
    const std::vector<LabelRun> runs = runs_of(labels, planes(), grid());
    return std::all_of(runs.begin(), runs.end(),
                       [&](const LabelRun& run) { return card_.labelling.allows(run); });
  }

  /// The strips of a patch with its plane moved by so many steps; none if that cannot be.
  [[nodiscard]] NewStrips moved(std::uint32_t patch, int by) {
    NewStrips out;
    for (int s = 0; s < grid().strips; ++s) {
      const std::uint32_t first = card_.first_run(s), end = card_.first_run(s + 1);
      std::vector<LabelRun> runs;
      for (std::uint32_t k = first; k < end; ++k) {
        if (patches().patch[k] != patch) continue;
        if (runs.empty()) runs = card_.runs_of_strip(s);
        if (!move_run(runs, k - first, by)) return {};
      }
      if (runs.empty()) continue;
      if (card_.labelling.is_fixed(s)) return {};
      std::vector<Label> labels(static_cast<std::size_t>(grid().columns));
      for (const LabelRun& run : runs) {
        if (!card_.labelling.allows(run)) return {};
        std::fill(labels.begin() + run.begin, labels.begin() + run.end, run.label);
      }
      out.push_back({s, std::move(labels)});
    }
    work_ += patches().runs.size() / 16;
    return out;
  }

  /// A run in a plane so many steps on, and its folds where that meets others. Whether there is
  /// such a plane.
  [[nodiscard]] bool move_run(std::vector<LabelRun>& runs, std::size_t r, int by) const {
    const FacetPlane& plane = planes()[runs[r].label];
    const int shift = plane.upright ? by : -by;
    runs[r].label = planes().find({plane.upright, plane.offset + by});
    if (runs[r].label == kNoLabel) return false;
    if (r > 0 && runs[r].folds_on) runs[r].begin += shift, runs[r - 1].end += shift;
    if (r + 1 < runs.size() && runs[r + 1].folds_on)
      runs[r].end += shift, runs[r + 1].begin += shift;
    return true;
  }

  /// Takes labels if everything holds with them.
  bool accept(const NewStrips& strips) {
    LabelHolding then = card_.holding_with(strips);
    work_ += then.patches.runs.size();
    if (then.open > 0 || (keeps_folds_ && missing_with(strips) > missing_mm() + kLeastGain))
      return false;
    card_.take(strips, std::move(then));
    for (const auto& [s, labels] : strips)
      for (int k = std::max(0, s - 1); k <= std::min(grid().strips - 1, s + 1); ++k)
        stale_[static_cast<std::size_t>(k)] = 1;
    ++moved_;
    return true;
  }

  static constexpr std::size_t kMostNeighbours = 8;
  static constexpr int kMostWays = 8;
  static constexpr double kLeastGain = 1e-3;  ///< mm^3: less is rounding

  LabelCard card_;
  std::vector<std::uint8_t> stale_;  ///< strips that may have become better to solve
  double min_fold_mm_{};
  bool keeps_folds_{};  ///< no move makes creases shorter
  std::size_t most_work_, work_{}, moved_{};
};

}  // namespace

std::size_t move_patches(Labelling& labelling, const HoldRule& rule, double min_fold_mm,
                         std::size_t most_work) {
  return PatchMover(labelling, rule, min_fold_mm, most_work).run();
}

}  // namespace popcut
