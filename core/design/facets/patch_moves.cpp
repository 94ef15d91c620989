// SPDX-License-Identifier: MIT
#include "core/design/facets/patch_moves.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/design/facets/label_holding.hpp"

namespace popcut {
namespace {

/// A strip with other labels.
struct NewStrip {
  int strip{};
  std::vector<Label> labels;
};

class PatchMover {
 public:
  PatchMover(Labelling& labelling, double min_panel_mm, std::size_t most_work)
      : labelling_(labelling), min_panel_mm_(min_panel_mm), most_work_(most_work) {
    stale_.assign(static_cast<std::size_t>(grid().strips), 1);
    runs_ = strip_runs(image(), planes());
    patches_ = patches_of(runs_, grid(), min_panel_mm_);
  }

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

  [[nodiscard]] const FacetPlanes& planes() const { return labelling_.planes(); }
  [[nodiscard]] const LabelImage& image() const { return labelling_.image(); }
  [[nodiscard]] const FacetGrid& grid() const { return image().grid; }
  [[nodiscard]] bool is_over() const { return work_ > most_work_; }

  /// A place in each patch that is neither in the wall nor in the ground.
  [[nodiscard]] std::vector<Place> places() const {
    std::vector<Place> out(patches_.count);
    for (int s = 0; s < grid().strips; ++s)
      for (std::uint32_t r = first_run(s); r < first_run(s + 1); ++r) {
        Place& place = out[patches_.patch[r]];
        if (place.strip < 0 && planes()[patches_.runs[r].label].offset != 0)
          place = {s, patches_.runs[r].begin};
      }
    std::erase_if(out, [](const Place& place) { return place.strip < 0; });
    return out;
  }
  /// Before the strips there is one of card.
  [[nodiscard]] std::uint32_t first_run(int s) const {
    return patches_.first_run[static_cast<std::size_t>(s) + 1];
  }
  [[nodiscard]] std::uint32_t patch_at(const Place& place) const {
    std::uint32_t r = first_run(place.strip);
    while (patches_.runs[r].end <= place.column) ++r;
    return patches_.patch[r];
  }

  void move_all() {
    for (const Place& place : places()) {
      if (is_over()) return;
      const std::uint32_t patch = patch_at(place);
      std::vector<NewStrip> best;
      double least = -kLeastGain;
      for (const int by : {-1, 1, -2, 2, -4, 4}) {
        std::vector<NewStrip> strips = moved(patch, by);
        if (strips.empty()) continue;
        const double extra = extra_cost(strips);
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
      const std::vector<Label> best = labelling_.best(s, true);
      if (!take_if_better({{s, best}})) take_stretches(s, best);
    }
  }

  bool take_if_better(const std::vector<NewStrip>& strips) {
    return extra_cost(strips) < -kLeastGain && accept(strips);
  }

  /// The stretches in which `best` differs from a strip, one by one.
  void take_stretches(int s, const std::vector<Label>& best) {
    const auto strip = image().strip(s);
    std::vector<Label> now(strip.begin(), strip.end());
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
                       [&](const LabelRun& run) { return labelling_.allows(run); });
  }

  /// The strips of a patch with its plane moved by so many steps; none if that cannot be.
  [[nodiscard]] std::vector<NewStrip> moved(std::uint32_t patch, int by) {
    std::vector<NewStrip> out;
    for (int s = 0; s < grid().strips; ++s) {
      const std::uint32_t first = first_run(s), end = first_run(s + 1);
      std::vector<LabelRun> runs;
      for (std::uint32_t k = first; k < end; ++k) {
        if (patches_.patch[k] != patch) continue;
        if (runs.empty()) runs.assign(patches_.runs.begin() + first, patches_.runs.begin() + end);
        if (!move_run(runs, k - first, by)) return {};
      }
      if (runs.empty()) continue;
      std::vector<Label> labels(static_cast<std::size_t>(grid().columns));
      for (const LabelRun& run : runs) {
        if (!labelling_.allows(run)) return {};
        std::fill(labels.begin() + run.begin, labels.begin() + run.end, run.label);
      }
      out.push_back({s, std::move(labels)});
    }
    work_ += patches_.runs.size() / 16;
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

  /// What labels cost more than those that are there.
  double extra_cost(const std::vector<NewStrip>& strips) {
    double sum = 0.0;
    std::vector<NewStrip> before;
    for (const auto& [s, labels] : strips) {
      const auto old = image().strip(s);
      before.push_back({s, {old.begin(), old.end()}});
      sum += labelling_.cost(s, labels) - labelling_.cost(s, old);
      labelling_.set(s, labels);
    }
    for (const auto& [s, labels] : before) labelling_.set(s, labels);
    return sum;
  }

  /// Takes labels if everything holds with them.
  bool accept(const std::vector<NewStrip>& strips) {
    std::vector<std::pair<std::size_t, std::vector<LabelRun>>> before;
    for (const auto& [s, labels] : strips) {
      const auto at = static_cast<std::size_t>(s) + 1;
      before.emplace_back(at, std::exchange(runs_[at], runs_of(labels, planes(), grid())));
    }
    LabelHolding then = holding_of(runs_, planes(), grid(), min_panel_mm_);
    work_ += then.patches.runs.size();
    if (then.open > 0) {
      for (auto& [at, runs] : before) runs_[at] = std::move(runs);
      return false;
    }
    patches_ = std::move(then.patches);
    for (const auto& [s, labels] : strips) {
      labelling_.set(s, labels);
      for (int k = std::max(0, s - 1); k <= std::min(grid().strips - 1, s + 1); ++k)
        stale_[static_cast<std::size_t>(k)] = 1;
    }
    ++moved_;
    return true;
  }

  static constexpr double kLeastGain = 1e-3;  ///< mm^3: less is rounding

  Labelling& labelling_;
  double min_panel_mm_;
  StripRuns runs_;  ///< with a strip of card before and after, as the next
  LabelPatches patches_;
  std::vector<std::uint8_t> stale_;  ///< strips that may have become better to solve
  std::size_t most_work_, work_{}, moved_{};
};

}  // namespace

std::size_t move_patches(Labelling& labelling, double min_panel_mm, std::size_t most_work) {
  return PatchMover(labelling, min_panel_mm, most_work).run();
}

}  // namespace popcut
