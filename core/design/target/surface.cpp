// SPDX-License-Identifier: MIT
#include "core/design/target/surface.hpp"

#include "core/design/target/surface_kinds.hpp"

namespace popcut {
namespace {

/// Picks the maker of each kind.
struct Make {
  const TargetPlacement& placement;
  FitMode fit;
  const SurfaceAssets& assets;

  Result<Surface> operator()(const RevolutionSpec& s) const {
    return surface_revolution(s, placement, fit);
  }
  Result<Surface> operator()(const ProfileSpec& s) const {
    return surface_profile(s, placement, fit);
  }
  Result<Surface> operator()(const ImplicitSpec& s) const {
    return surface_implicit(s, placement, fit);
  }
  Result<Surface> operator()(const GridSpec& s) const {
    return surface_grid(s, placement, fit, assets);
  }
  Result<Surface> operator()(const MeshSpec& s) const {
    return surface_mesh(s, placement, fit, assets);
  }
};

}  // namespace

Result<Surface> Surface::make(const SurfaceSpec& spec, const TargetPlacement& placement,
                              FitMode fit, const SurfaceAssets& assets) {
  return std::visit(Make{placement, fit, assets}, spec);
}

}  // namespace popcut
