// SPDX-License-Identifier: MIT
#include "core/judge/sound_boxes.hpp"

#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "core/design/boxes/tented_card.hpp"
#include "core/hands/wobble.hpp"
#include "core/judge/sound_layers.hpp"
#include "core/parts/structure_fold.hpp"

namespace popcut::judge {

namespace {

/// The play (`TentSection::play_mm`) with which the loosest glued roof would hold: what it moves by
/// on its sheet is about proportional to it. None: the card holds, or what is loose is no roof.
std::optional<double> roof_play_for(const BoxedCard& made, const PartsVerifyReport& report) {
  const double whole_mm = report.wobble_mm.value_or(0.0);
  if (whole_mm <= kHolds_mm) return std::nullopt;
  for (const CardTent& tent : made.tents)
    for (const std::size_t part : {tent.roof_part, tent.strut_part})
      if (report.wobbles_most == made.card.parts[part].name)
        return tent.section.play_mm(hands::Play{}.line_mm) * kHolds_mm / whole_mm;
  return std::nullopt;
}

}  // namespace

Result<SoundBoxes> sound_boxes(const DesignSpec& spec, const SurfaceAssets& assets,
                               const std::string& creator, const Progress& progress) {
  double most_play_mm = std::numeric_limits<double>::infinity();
  for (;;) {
    auto made = has_tents(spec) ? tented_card(spec, assets, most_play_mm, progress)
                                : boxed_card(spec, assets, progress);
    if (!made) return tl::unexpected(made.error());
    auto sound = sound_boxes(std::move(*made), creator, progress);
    if (!sound) return sound;
    const PartsVerifyReport& report = sound->report;
    // Less than the play of one of its roofs, so the next card lacks that roof.
    if (const auto play_mm = roof_play_for(sound->made, report)) {
      most_play_mm = *play_mm;
      continue;
    }
    return sound;
  }
}

Result<SoundBoxes> sound_boxes(BoxedCard made, const std::string& creator,
                               const Progress& progress) {
  auto fold = structure_fold(made.card, creator);
  if (!fold) return tl::unexpected(fold.error());
  auto report = sound_report(*fold, "try another size", progress);
  if (!report) return tl::unexpected(report.error());
  made.wobble_mm = report->wobble_mm;
  warn_of_moves(*report,
                made.is_of_facets() ? "make panels hold at places farther apart"
                                    : "crease and glue it exactly",
                made.warnings);
  return SoundBoxes{std::move(made), std::move(*fold), std::move(*report)};
}

}  // namespace popcut::judge
