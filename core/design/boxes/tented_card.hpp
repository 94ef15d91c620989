// SPDX-License-Identifier: MIT
#pragma once

#include "core/design/boxes/boxed_card.hpp"

namespace popcut {

/// A card of facets with glued roofs (`"sloped": "tents"`, docs/facets.md): the sheet, and a roof
/// and its strut for each sloped plane.
///
/// @param most_play_mm  that its ridge may have beside what the sheet does
/// (`TentSection::play_mm`):
///                      looser roofs become stairs
/// @retval Infeasible  no roof can be glued on, or a given page is too small; else as
///                     `facet_design`
[[nodiscard]] Result<BoxedCard> tented_card(const DesignSpec& spec, const SurfaceAssets& assets,
                                            double most_play_mm, const Progress& progress = {});

}  // namespace popcut
