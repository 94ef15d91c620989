// SPDX-License-Identifier: MIT
#include "core/design/target/surface.hpp"

#include <utility>

#include <fmt/format.h>

#include "core/design/target/surface_kinds.hpp"
#include "core/fit/triangle_soup.hpp"
#include "core/geometry/design_angle.hpp"

namespace popcut {
namespace {

Result<Surface> of_kind(const SurfaceSpec& spec, const TargetPlacement& placement, FitMode fit,
                        const SurfaceAssets& assets) {
  if (const auto* revolution = std::get_if<RevolutionSpec>(&spec))
    return surface_revolution(*revolution, placement, fit);
  if (const auto* profile = std::get_if<ProfileSpec>(&spec))
    return surface_profile(*profile, placement, fit);
  if (const auto* loft = std::get_if<LoftSpec>(&spec)) return surface_loft(*loft, placement, fit);
  if (const auto* implicit = std::get_if<ImplicitSpec>(&spec))
    return surface_implicit(*implicit, placement, fit);
  return surface_of_mesh(spec, placement, fit, assets);
}

/// Errors about places in a section say what x and z are, where these are oblique.
Error in_section(Error error, double angle_deg) {
  if (error.kind == ErrorKind::Infeasible && error.place.rfind("/surface", 0) == 0)
    error.detail +=
        fmt::format(" (x is along the ground, z along the wall at {:g} degrees)", angle_deg);
  return error;
}

/// A surface whose slices and triangles are in oblique coordinates: distances of its curves are
/// those in space, and its triangles are in space.
Surface sheared(Surface oblique, double angle_deg) {
  const DesignAngle opening = DesignAngle::of_deg(angle_deg);
  const auto cut = [oblique, opening, angle_deg](double s_mm) -> Result<SurfaceSlice> {
    auto slice = oblique.cut(s_mm);
    if (!slice) return tl::unexpected(in_section(slice.error(), angle_deg));
    slice->curve.set_opening(opening);
    return slice;
  };
  return Surface(cut, [oblique, opening](const TargetStretch& stretch) {
    TriangleSoup soup = oblique.triangles(stretch);
    for (std::size_t k = 0; k < soup.corners.size(); k += 3)
      opening.to_space(soup.corners[k], soup.corners[k + 2]);
    return soup;
  });
}

}  // namespace

Result<Surface> Surface::make(const SurfaceSpec& spec, const TargetPlacement& placement,
                              FitMode fit, const SurfaceAssets& assets) {
  auto made = of_kind(spec, placement, fit, assets);
  const double angle_deg = placement.design_angle_deg;
  if (angle_deg == 90.0) return made;
  if (!made) return tl::unexpected(in_section(made.error(), angle_deg));
  return sheared(std::move(*made), angle_deg);
}

TriangleSoup Surface::triangles(const TargetStretch& stretch) const { return tessellate_(stretch); }

}  // namespace popcut
