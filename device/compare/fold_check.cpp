// SPDX-License-Identifier: MIT
#include "device/compare/fold_check.hpp"

#include <algorithm>

namespace popcut {
namespace {

bool holds(const std::vector<Stretch>& stretches, double s) {
  return std::any_of(stretches.begin(), stretches.end(),
                     [&](const Stretch& stretch) { return s >= stretch.from && s <= stretch.to; });
}

/// The longest part of `gap` that needs a dash.
double longest_free(const FoldState& fold, const Stretch& gap) {
  double free = 0;
  double free_from = gap.from;
  for (const Stretch& stretch : fold.bare) {
    if (stretch.from >= gap.to) break;
    free = std::max(free, std::min(stretch.from, gap.to) - free_from);
    free_from = std::max(free_from, stretch.to);
  }
  return std::max(free, gap.to - free_from);
}

}  // namespace

std::string_view words_of(FoldFault::Kind kind) {
  switch (kind) {
    case FoldFault::Kind::NotDashed:
      return "not dashed";
    case FoldFault::Kind::TooOften:
      return "dashed more often than it should be";
    case FoldFault::Kind::Solid:
      return "cut solid";
    case FoldFault::Kind::ToItsEnd:
      return "cut up to its end";
  }
  return "";
}

std::optional<FoldFault> check_fold(const FoldState& fold, const DashShape& shape, int passes,
                                    double slack_mm) {
  const std::vector<Stretch>& dashes = fold.dashes;
  const double end_paper = 0.5 * shape.clearance_mm - slack_mm;
  if (!dashes.empty()) {
    const double first = dashes.front().from;
    if (first < end_paper && !holds(fold.cut, first))
      return FoldFault{FoldFault::Kind::ToItsEnd, dashes.front()};
    const auto last = std::max_element(dashes.begin(), dashes.end(),
                                       [](Stretch a, Stretch b) { return a.to < b.to; });
    if (last->to > fold.length_mm - end_paper && !holds(fold.cut, last->to))
      return FoldFault{FoldFault::Kind::ToItsEnd, *last};
  }
  Stretch solid;  // cut without a gap, so far
  int layers = 0;
  for (std::size_t k = 0; k <= dashes.size(); ++k) {
    const double next = k < dashes.size() ? dashes[k].from : fold.length_mm;
    if (next > solid.to + slack_mm) {
      const Stretch gap{solid.to, next};
      if (gap.to - gap.from > shape.gap_mm + slack_mm &&
          longest_free(fold, gap) > shape.min_dash_mm + slack_mm)
        return FoldFault{FoldFault::Kind::NotDashed, gap};
      solid = {next, next};
      layers = 0;
    }
    if (k == dashes.size()) break;
    if (dashes[k].from < solid.to - slack_mm) ++layers;
    solid.to = std::max(solid.to, dashes[k].to);
    if (holds(fold.cut, (solid.from + solid.to) / 2)) continue;
    if (layers >= passes) return FoldFault{FoldFault::Kind::TooOften, solid};
    if (solid.to - solid.from > shape.dash_mm + shape.gap_mm + slack_mm)
      return FoldFault{FoldFault::Kind::Solid, solid};
  }
  return std::nullopt;
}

}  // namespace popcut
