// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/design/boxes/boxed_card.hpp"
#include "core/design/layers/layered_card.hpp"
#include "core/design/slices/sliced_card.hpp"
#include "core/design/spec/spec.hpp"
#include "core/design/target/surface_spec.hpp"
#include "core/formats/lattice/lattice_blob.hpp"
#include "core/parts/structure.hpp"
#include "core/progress.hpp"
#include "core/result.hpp"
#include "core/warning.hpp"

namespace popcut::planning {

/// A card of several parts that was designed from a spec: of layers, of slices or of boxes.
struct PartsCard {
  std::optional<LayeredCard> layers;
  std::optional<SlicedCard> slices;
  std::optional<BoxedCard> boxes;
  std::string fold;  ///< its file

  [[nodiscard]] const Structure& card() const {
    return layers ? layers->card : slices ? slices->card : boxes->card;
  }
  [[nodiscard]] const std::vector<Warning>& warnings() const {
    return layers ? layers->warnings : slices ? slices->warnings : boxes->warnings;
  }
  /// Its `report.json`.
  [[nodiscard]] std::string report() const;
};

/// @param is_checked  false: verify need not look at it, which is quicker
/// @retval Internal  verify finds faults; else as `layered_card`, `sliced_card` and `boxed_card`
[[nodiscard]] Result<PartsCard> parts_card(const DesignSpec& spec, const SurfaceAssets& assets,
                                           bool is_checked, const Progress& progress = {});

/// The lattice blob of a card of several parts, its sheets side by side, from its FOLD file; the
/// parts and their motion go into `how`.
[[nodiscard]] Result<std::string> parts_blob(std::string_view fold, LatticeBlobOptions how);
/// The same of a card that was designed, with its report.
[[nodiscard]] Result<std::string> shown_blob(const PartsCard& made, LatticeQuality quality);

/// A small picture of the open card, from in front and above.
[[nodiscard]] Result<std::string> small_parts_svg(std::string_view fold);

}  // namespace popcut::planning
