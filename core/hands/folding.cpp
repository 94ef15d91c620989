// SPDX-License-Identifier: MIT
#include "core/hands/folding.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <vector>

#include <fmt/format.h>

#include "core/hands/waste.hpp"

namespace popcut::hands {
namespace {

constexpr double kRounding_mm = 1e-6;  ///< lengths of one design differ by rounding

/// A fold as a part of its line, which is given by its direction and its distance from the corner.
/// The first two are rounded, so that pieces of one line agree.
struct FoldPiece {
  EdgeRole role{};
  double turn{}, aside_mm{}, from_mm{}, to_mm{};
};

FoldPiece piece_of(const SheetLine& line) {
  double du = line.u1 - line.u0, dv = line.v1 - line.v0;
  const double length = std::hypot(du, dv);
  if (length > 0) du /= length, dv /= length;
  const auto rounded = [](double x) { return std::round(x * 1e6) / 1e6 + 0.0; };
  if (rounded(dv) < 0 || (rounded(dv) == 0 && du < 0)) du = -du, dv = -dv;
  const double a = line.u0 * du + line.v0 * dv, b = line.u1 * du + line.v1 * dv;
  return {line.role, rounded(du), rounded(line.u0 * dv - line.v0 * du), std::min(a, b),
          std::max(a, b)};
}

/// Pieces of a line that touch are creased as one. O(n log n).
void add_creases(const Pattern& pattern, std::vector<double>& lengths_mm) {
  std::vector<FoldPiece> pieces;
  for (const SheetLine& line : pattern.lines)
    if (line.role == EdgeRole::Mountain || line.role == EdgeRole::Valley)
      pieces.push_back(piece_of(line));
  const auto line_of = [](const FoldPiece& p) { return std::tuple(p.role, p.turn, p.aside_mm); };
  std::ranges::sort(pieces, [&](const FoldPiece& a, const FoldPiece& b) {
    return std::tuple(line_of(a), a.from_mm) < std::tuple(line_of(b), b.from_mm);
  });
  for (std::size_t k = 0; k < pieces.size();) {
    double end_mm = pieces[k].to_mm;
    std::size_t next = k + 1;
    while (next < pieces.size() && line_of(pieces[next]) == line_of(pieces[k]) &&
           pieces[next].from_mm <= end_mm + kRounding_mm)
      end_mm = std::max(end_mm, pieces[next++].to_mm);
    lengths_mm.push_back(end_mm - pieces[k].from_mm);
    k = next;
  }
}

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
    add_creases(*pattern, lengths_mm);
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
