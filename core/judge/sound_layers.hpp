// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "core/design/layers/layered_card.hpp"
#include "core/progress.hpp"
#include "core/result.hpp"
#include "core/verify/parts/parts.hpp"
#include "core/warning.hpp"

namespace popcut::judge {

/// A card of layers that verify has found sound, and its file.
struct SoundLayers {
  LayeredCard made;
  std::string fold;
  PartsVerifyReport report;
};

/// What verify says of the FOLD file of a card that popcut made.
///
/// @param try_instead  "try other layers or another size"
/// @retval Internal  it finds faults
[[nodiscard]] Result<PartsVerifyReport> sound_report(const std::string& fold,
                                                     const char* try_instead,
                                                     const Progress& progress);

/// Warns of a card whose panels move by more than `kHolds_mm` in paper.
///
/// @param what_helps  "crease and glue it exactly"
void warn_of_moves(const PartsVerifyReport& report, const char* what_helps,
                   std::vector<Warning>& warnings);

/// Designs a card of layers (`layered_card`), and judges it by its FOLD file.
///
/// @retval Internal  verify finds faults; else as `layered_card`
[[nodiscard]] Result<SoundLayers> sound_layers(const DesignSpec& spec, const SurfaceAssets& assets,
                                               const std::string& creator,
                                               const Progress& progress = {});
/// The same of a card that is designed already.
[[nodiscard]] Result<SoundLayers> sound_layers(LayeredCard made, const std::string& creator,
                                               const Progress& progress = {});

}  // namespace popcut::judge
