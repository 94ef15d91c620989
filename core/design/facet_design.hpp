// SPDX-License-Identifier: MIT
#pragma once

#include "core/design/design.hpp"

namespace popcut {

/// A design of facets (`"style": "facets"`, docs/facets.md), as `design` makes one.
///
/// @retval Malformed   the surface's expression or file cannot be read
/// @retval OutOfRange  too many cells, or a card that is too small; `place` names the field
/// @retval Infeasible  nothing of the surface stands in the corner, or nothing of it holds
[[nodiscard]] Result<Design> facet_design(const DesignSpec& spec, const SurfaceAssets& assets,
                                          const Progress& progress);

}  // namespace popcut
