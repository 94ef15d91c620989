// SPDX-License-Identifier: MIT
#include "core/design/target/surface.hpp"

#include "core/design/target/surface_kinds.hpp"
#include "core/fit/triangle_soup.hpp"

namespace popcut {

Result<Surface> Surface::make(const SurfaceSpec& spec, const TargetPlacement& placement,
                              FitMode fit, const SurfaceAssets& assets) {
  if (const auto* revolution = std::get_if<RevolutionSpec>(&spec))
    return surface_revolution(*revolution, placement, fit);
  if (const auto* profile = std::get_if<ProfileSpec>(&spec))
    return surface_profile(*profile, placement, fit);
  if (const auto* implicit = std::get_if<ImplicitSpec>(&spec))
    return surface_implicit(*implicit, placement, fit);
  return surface_of_file(spec, placement, fit, assets);
}

TriangleSoup Surface::triangles(const TargetStretch& stretch) const { return tessellate_(stretch); }

}  // namespace popcut
