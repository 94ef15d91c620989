// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "core/design/layers/layered_card.hpp"
#include "core/progress.hpp"
#include "core/result.hpp"
#include "core/verify/parts/parts.hpp"

namespace popcut::judge {

/// A card of layers that verify has found sound, and its file.
struct SoundLayers {
  LayeredCard made;
  std::string fold;
  PartsVerifyReport report;
};

/// Designs a card of layers (`layered_card`), and judges it by its FOLD file.
///
/// @retval Internal  verify finds faults; else as `layered_card`
[[nodiscard]] Result<SoundLayers> sound_layers(const DesignSpec& spec, const SurfaceAssets& assets,
                                               const std::string& creator,
                                               const Progress& progress = {});

}  // namespace popcut::judge
