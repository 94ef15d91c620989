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

/// A card of boxes (`boxed_card`), or of facets with glued roofs (`tented_card`).
[[nodiscard]] Result<BoxedCard> designed_boxes(const DesignSpec& spec, const SurfaceAssets& assets,
                                               const Progress& progress = {});

/// Designs such a card, and judges it by its FOLD file.
///
/// @retval Internal  verify finds faults; else as `designed_boxes`
[[nodiscard]] Result<SoundBoxes> sound_boxes(const DesignSpec& spec, const SurfaceAssets& assets,
                                             const std::string& creator,
                                             const Progress& progress = {});

}  // namespace popcut::judge
