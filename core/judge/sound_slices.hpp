// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "core/design/slices/sliced_card.hpp"
#include "core/progress.hpp"
#include "core/result.hpp"
#include "core/verify/parts/parts.hpp"

namespace popcut::judge {

/// A card of slices that verify has found sound, and its file.
struct SoundSlices {
  SlicedCard made;
  std::string fold;
  PartsVerifyReport report;
};

/// Designs a card of slices (`sliced_card`), and judges it by its FOLD file.
///
/// @retval Internal  verify finds faults; else as `sliced_card`
[[nodiscard]] Result<SoundSlices> sound_slices(const DesignSpec& spec, const SurfaceAssets& assets,
                                               const std::string& creator,
                                               const Progress& progress = {});

}  // namespace popcut::judge
