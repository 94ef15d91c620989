// SPDX-License-Identifier: MIT
#include "core/design/facets/label_card.hpp"

#include <algorithm>
#include <map>
#include <utility>

namespace popcut {

std::vector<Label> labels_of(const LabelImage& image, int strip) {
  const auto labels = image.strip(strip);
  return {labels.begin(), labels.end()};
}

double extra_cost(Labelling& labelling, const NewStrips& strips) {
  double sum = 0.0;
  NewStrips before;
  for (const auto& [s, labels] : strips) {
    sum += labelling.cost(s, labels) - labelling.cost_now(s);
    if (&labels == &strips.back().labels) break;  // no other one's cost follows from it
    before.push_back({s, labels_of(labelling.image(), s)});
    labelling.set(s, labels);
  }
  for (const auto& [s, labels] : before) labelling.set(s, labels);
  return sum;
}

LabelCard::LabelCard(Labelling& labels, const HoldRule& hold_rule)
    : labelling(labels), rule(hold_rule), runs(strip_runs(image(), planes())) {
  holding = holding_of(runs, planes(), grid(), rule);
}

LabelHolding LabelCard::holding_with(const NewStrips& strips) {
  std::vector<std::pair<std::size_t, std::vector<LabelRun>>> before;
  for (const auto& [s, labels] : strips) {
    const auto at = static_cast<std::size_t>(s) + 1;
    before.emplace_back(at, std::exchange(runs[at], runs_of(labels, planes(), grid())));
  }
  LabelHolding then = holding_of(runs, planes(), grid(), rule);
  for (auto& [at, old] : before) runs[at] = std::move(old);
  return then;
}

void LabelCard::take(const NewStrips& strips, LabelHolding then) {
  for (const auto& [s, labels] : strips) {
    labelling.set(s, labels);
    runs[static_cast<std::size_t>(s) + 1] = runs_of(labels, planes(), grid());
  }
  holding = std::move(then);
}

void LabelCard::take(const LabelImage& image) {
  for (int s = 0; s < grid().strips; ++s) labelling.set(s, labels_of(image, s));
  runs = strip_runs(image, planes());
  holding = holding_of(runs, planes(), grid(), rule);
}

std::map<std::uint32_t, LoosePatch> patch_cells(const LabelCard& card, bool only_loose) {
  std::map<std::uint32_t, LoosePatch> by_patch;
  for (int s = 0; s < card.grid().strips; ++s) {
    const std::vector<LabelRun>& runs = card.runs_of_strip(s);
    for (std::size_t r = 0; r < runs.size(); ++r) {
      if (only_loose && !card.is_loose(s, r)) continue;
      LoosePatch& patch = by_patch[card.patch_of(s, r)];
      patch.area += runs[r].end - runs[r].begin;
      patch.cells.push_back({s, runs[r].begin, runs[r].end, runs[r].label});
    }
  }
  return by_patch;
}

std::vector<LoosePatch> loose_patches(const LabelCard& card) {
  std::map<std::uint32_t, LoosePatch> by_patch = patch_cells(card, true);
  std::vector<LoosePatch> out;
  out.reserve(by_patch.size());
  for (auto& [number, patch] : by_patch) out.push_back(std::move(patch));
  std::stable_sort(out.begin(), out.end(),
                   [](const LoosePatch& a, const LoosePatch& b) { return a.area < b.area; });
  return out;
}

double looseness(const LabelHolding& holding) {
  constexpr double kOpen = 0.03;
  return holding.pins + kOpen * static_cast<double>(holding.open);
}

}  // namespace popcut
