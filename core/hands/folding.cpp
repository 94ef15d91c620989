// SPDX-License-Identifier: MIT
#include "core/hands/folding.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "core/hands/waste.hpp"

namespace popcut::hands {
namespace {

constexpr double kRounding_mm = 1e-6;  ///< lengths of one design differ by rounding

}  // namespace

Handwork handwork(std::span<const double> fold_lengths_mm, std::size_t waste, std::size_t tabs,
                  const Hands& hands) {
  Handwork out;
  out.folds = fold_lengths_mm.size();
  out.waste = waste, out.tabs = tabs;
  out.time_s = hands.waste_s * static_cast<double>(waste) + hands.tab_s * static_cast<double>(tabs);
  for (const double length_mm : fold_lengths_mm)
    for (const Hands::FoldTime& row : hands.folds) {
      if (length_mm < row.from_mm - kRounding_mm) continue;
      out.time_s += row.fold_s;
      break;
    }
  if (!fold_lengths_mm.empty()) out.shortest_mm = std::ranges::min(fold_lengths_mm);
  out.label = "hard";
  for (const Hands::Grade& grade : hands.grades) {
    if (out.folds > grade.most_folds) continue;
    if (out.folds > 0 && out.shortest_mm < grade.shortest_mm - kRounding_mm) continue;
    out.label = grade.label;
    break;
  }
  return out;
}

Handwork handwork(std::span<const Pattern* const> patterns, const Hands& hands) {
  std::vector<double> lengths_mm;
  std::size_t waste = 0;
  for (const Pattern* pattern : patterns) {
    waste += waste_pieces(*pattern);
    for (const SheetLine& line : pattern->lines)
      if (line.role == EdgeRole::Mountain || line.role == EdgeRole::Valley)
        lengths_mm.push_back(std::hypot(line.u1 - line.u0, line.v1 - line.v0));
  }
  return handwork(lengths_mm, waste, 0, hands);
}

Handwork handwork(const Pattern& pattern, const Hands& hands) {
  const Pattern* const one = &pattern;
  return handwork({&one, 1}, hands);
}

std::string minutes_words(double time_s) {
  if (time_s < 60.0) return "under a minute";
  const double minutes = std::round(time_s / 60.0);
  return fmt::format("about {:.0f} minute{}", minutes, minutes == 1.0 ? "" : "s");
}

std::string handwork_words(const Handwork& work) {
  if (work.folds == 0) return "no folds";
  return fmt::format("{} fold{}, the shortest {:.3g} mm; {} to fold ({})", work.folds,
                     work.folds == 1 ? "" : "s", work.shortest_mm, minutes_words(work.time_s),
                     work.label);
}

}  // namespace popcut::hands
