// SPDX-License-Identifier: MIT
#include "daemon/planning/search/found_front.hpp"

#include <fmt/format.h>

namespace popcut::planning {
namespace found_front_parts {
namespace {

daemon::FoundCardRecord record_of(const FoundCard& card) {
  daemon::FoundCardRecord out;
  out.style = std::string(style_name(card.candidate));
  out.settings = settings_words(card.candidate);
  const likeness::Figures& f = card.figures;
  out.error = card.error(), out.surface = f.surface(), out.contour = f.contour();
  out.cover = f.cover, out.excess = f.excess;
  if (card.printed) out.looks = likeness::name_of(likeness::looks(*card.printed));
  out.seconds = card.cost.seconds, out.seconds_range = card.cost.seconds_range;
  out.cut_mm = card.cost.cut_mm, out.fold_mm = card.cost.fold_mm;
  out.sheet_mm = card.facts.sheet_mm, out.page_mm = card.facts.page_mm;
  out.folds = static_cast<int>(card.cost.hands.folds);
  out.shortest_fold_mm = card.cost.hands.shortest_mm, out.hand_seconds = card.cost.hands.time_s;
  out.label = card.cost.hands.label, out.wobble_mm = card.cost.wobble_mm;
  out.warnings = card.facts.warnings;
  out.spec = card.spec;
  return out;
}

daemon::FoundCardRecord record_of_glued(const FoundGlued& card) {
  const Structure& made = card.card();
  daemon::FoundCardRecord out;
  out.style = card.style();
  out.settings = fmt::format("{} on a card that opens flat", card.made_of());
  const likeness::PrintedFigures& f = card.printed;
  out.error = f.error(), out.surface = f.colour, out.contour = f.contour, out.cover = f.cover;
  out.looks = likeness::name_of(likeness::looks(f));
  out.seconds = card.seconds, out.seconds_range = card.seconds_range;
  out.cut_mm = card.cut_mm, out.fold_mm = card.fold_mm;
  out.sheet_mm = {2.0 * made.page_mm, made.length_mm};
  out.folds = static_cast<int>(card.hands.folds), out.tabs = static_cast<int>(card.hands.tabs);
  out.shortest_fold_mm = card.hands.shortest_mm, out.hand_seconds = card.hands.time_s;
  out.label = card.hands.label, out.wobble_mm = card.wobble_mm();
  out.warnings = card.warnings();
  out.spec = card.spec;
  return out;
}

}  // namespace
}  // namespace found_front_parts

std::string settings_words(const Candidate& candidate) {
  if (candidate.style == DesignStyle::Facets)
    return fmt::format("facets in strips of {:g} mm, planes {:g} mm apart{}", candidate.strip_mm,
                       candidate.pitch_mm, candidate.kites ? ", sloped roofs" : "");
  if (candidate.style == DesignStyle::Silhouette)
    return fmt::format("silhouette in {} layer{}", candidate.layers,
                       candidate.layers == 1 ? "" : "s");
  return fmt::format("{} lattice, {} slices of {} units", style_name(candidate), candidate.slices,
                     candidate.units);
}

daemon::SearchFront figures_of(const FoundCards& found, std::span<const FoundGlued> glued) {
  daemon::SearchFront out;
  for (const FoundCard& card : found.front) out.cards.push_back(found_front_parts::record_of(card));
  for (const FoundGlued& card : glued)
    out.cards.push_back(found_front_parts::record_of_glued(card));
  out.designed = static_cast<int>(found.counts.designed);
  out.planned = static_cast<int>(found.counts.planned);
  out.verified = static_cast<int>(found.counts.verified);
  out.seen_share = found.seen_share;
  out.mat_mm = found.area_mm;
  out.notes = found.notes;
  out.recommended = static_cast<int>(found.recommended) + 1;
  out.better_front = found.better_front;
  return out;
}

}  // namespace popcut::planning
