// SPDX-License-Identifier: MIT
#include "core/judge/sound_boxes.hpp"

#include <utility>

#include "core/design/boxes/tented_card.hpp"
#include "core/judge/sound_layers.hpp"
#include "core/parts/structure_fold.hpp"

namespace popcut::judge {

Result<BoxedCard> designed_boxes(const DesignSpec& spec, const SurfaceAssets& assets,
                                 const Progress& progress) {
  return has_tents(spec) ? tented_card(spec, assets, progress) : boxed_card(spec, assets, progress);
}

Result<SoundBoxes> sound_boxes(const DesignSpec& spec, const SurfaceAssets& assets,
                               const std::string& creator, const Progress& progress) {
  auto made = designed_boxes(spec, assets, progress);
  if (!made) return tl::unexpected(made.error());
  auto fold = structure_fold(made->card, creator);
  if (!fold) return tl::unexpected(fold.error());
  auto report = sound_report(*fold, "try another size", progress);
  if (!report) return tl::unexpected(report.error());
  return SoundBoxes{std::move(*made), std::move(*fold), std::move(*report)};
}

}  // namespace popcut::judge
