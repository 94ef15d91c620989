// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "core/design/boxes/boxed_card.hpp"
#include "core/progress.hpp"
#include "core/result.hpp"
#include "core/verify/parts/parts.hpp"

namespace popcut::judge {

/// A card of boxes that verify has found sound, and its file.
struct SoundBoxes {
  BoxedCard made;
  std::string fold;
  PartsVerifyReport report;
};

/// Designs a card of boxes (`boxed_card`), or of facets with glued roofs (`tented_card`), and
/// judges it by its FOLD file. A glued roof stays only if the card then moves by at most
/// `kHolds_mm`.
///
/// @retval Internal  verify finds faults; else as those functions
[[nodiscard]] Result<SoundBoxes> sound_boxes(const DesignSpec& spec, const SurfaceAssets& assets,
                                             const std::string& creator,
                                             const Progress& progress = {});
/// Judges a card that is designed already, with all of its roofs.
[[nodiscard]] Result<SoundBoxes> sound_boxes(BoxedCard made, const std::string& creator,
                                             const Progress& progress = {});

}  // namespace popcut::judge
