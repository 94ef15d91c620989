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

/// Designs a card of boxes (`boxed_card`), and judges it by its FOLD file.
///
/// @retval Internal  verify finds faults; else as `boxed_card`
[[nodiscard]] Result<SoundBoxes> sound_boxes(const DesignSpec& spec, const SurfaceAssets& assets,
                                             const std::string& creator,
                                             const Progress& progress = {});

}  // namespace popcut::judge
