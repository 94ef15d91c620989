// SPDX-License-Identifier: MIT
#pragma once

#include "core/design/design.hpp"
#include "core/design/facets/facets.hpp"
#include "core/fit/triangle_soup.hpp"

namespace popcut {

/// What a spec of facets asks for: its surface in space, mm, and the stretch of the spine. On the
/// sheet the stretch begins at the card's margin.
struct FacetTarget {
  TriangleSoup soup;
  double from_mm{}, to_mm{};
};

/// The same errors as `facet_design`, as far as they are about the surface.
[[nodiscard]] Result<FacetTarget> facet_target(const DesignSpec& spec, const SurfaceAssets& assets);

/// The facets of a spec, with the fewest folds that it asks for. The same errors as
/// `facet_design`, as far as they are about facets.
///
/// @param most_roof_play_mm  of a glued roof (`TentSection::play_mm`): looser ones become stairs
[[nodiscard]] Result<FacetCard> facets_of(const DesignSpec& spec, const FacetTarget& target,
                                          double most_roof_play_mm, const Progress& progress);

/// Adds the warnings about facets to a report, which has their work by hand.
void warn_of_facets(const DesignSpec& spec, const FacetTarget& target, const FacetCard& made,
                    DesignReport& report);

/// A design of facets (`"style": "facets"`, docs/facets.md), as `design` makes one.
///
/// @retval Malformed   the surface's expression or file cannot be read
/// @retval OutOfRange  too many cells, or a card that is too small; `place` names the field
/// @retval Infeasible  nothing of the surface stands in the corner, or nothing of it holds
[[nodiscard]] Result<Design> facet_design(const DesignSpec& spec, const SurfaceAssets& assets,
                                          const Progress& progress);

}  // namespace popcut
