// SPDX-License-Identifier: MIT
#include "core/design/facets/patch_moves.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/design/facets/label_card.hpp"

namespace popcut {
namespace {

class PatchMover {
 public:
  PatchMover(Labelling& labelling, const HoldRule& rule, std::size_t most_work)
      : card_(labelling, rule),
        stale_(static_cast<std::size_t>(card_.grid().strips), 1),
        most_work_(most_work) {}

  std::size_t run() {
    constexpr int kRounds = 3;
    for (int round = 0; round < kRounds; ++round) {
      const std::size_t before = moved_;
      solve_strips();
      move_all();
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
      for (const int by : {-1, 1, -2, 2, -4, 4}) {
        NewStrips strips = moved(patch, by);
        if (strips.empty()) continue;
        const double extra = extra_cost(card_.labelling, strips);
        if (extra < least) least = extra, best = std::move(strips);
      }
      if (!best.empty()) accept(best);
    }
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
    if (then.open > 0) return false;
    card_.take(strips, std::move(then));
    for (const auto& [s, labels] : strips)
      for (int k = std::max(0, s - 1); k <= std::min(grid().strips - 1, s + 1); ++k)
        stale_[static_cast<std::size_t>(k)] = 1;
    ++moved_;
    return true;
  }

  static constexpr double kLeastGain = 1e-3;  ///< mm^3: less is rounding

  LabelCard card_;
  std::vector<std::uint8_t> stale_;  ///< strips that may have become better to solve
  std::size_t most_work_, work_{}, moved_{};
};

}  // namespace

std::size_t move_patches(Labelling& labelling, const HoldRule& rule, std::size_t most_work) {
  return PatchMover(labelling, rule, most_work).run();
}

}  // namespace popcut
