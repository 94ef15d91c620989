// SPDX-License-Identifier: MIT
#pragma once

#include "core/design/boxes/boxed_card.hpp"

namespace popcut {

/// A card of facets with glued roofs (`"sloped": "tents"`, docs/facets.md): the sheet, and a roof
/// and its strut for each sloped plane.
///
/// @retval Infeasible  no roof can be glued on, or a given page is too small; else as
///                     `facet_design`
[[nodiscard]] Result<BoxedCard> tented_card(const DesignSpec& spec, const SurfaceAssets& assets,
                                            const Progress& progress = {});

}  // namespace popcut
