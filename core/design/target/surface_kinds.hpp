// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include <functional>

#include "core/design/target/placement_map.hpp"
#include "core/design/target/surface.hpp"
#include "core/model/triangle_mesh.hpp"
#include "core/warning.hpp"

namespace popcut {

/// The kinds of `Surface::make`, a file each.
[[nodiscard]] Result<Surface> surface_revolution(const RevolutionSpec& spec,
                                                 const TargetPlacement& placement, FitMode fit);
[[nodiscard]] Result<Surface> surface_profile(const ProfileSpec& spec,
                                              const TargetPlacement& placement, FitMode fit);
[[nodiscard]] Result<Surface> surface_loft(const LoftSpec& spec, const TargetPlacement& placement,
                                           FitMode fit);
[[nodiscard]] Result<Surface> surface_implicit(const ImplicitSpec& spec,
                                               const TargetPlacement& placement, FitMode fit);
/// Of a mesh, a grid, a text or a drawing.
[[nodiscard]] Result<Surface> surface_of_mesh(const SurfaceSpec& spec,
                                              const TargetPlacement& placement, FitMode fit,
                                              const SurfaceAssets& assets);

/// A solid by its sign: negative inside; where it is not a number is outside. In units of the
/// surface, x, y, z before the placement.
using SolidFunction = std::function<double(double, double, double)>;

/// Slices of a solid: its extent in the corner is sought along rays, its boundary by marching
/// squares of 192 x 192 cells with every crossing found by bisection. Parts thinner than a cell can
/// be missed. Where the section is a single falling curve, that is sampled from the solid itself.
[[nodiscard]] Surface surface_of_solid(SolidFunction solid, const TargetPlacement& placement,
                                       FitMode fit, const char* what);

/// The triangles of a surface that has a `solid_word`, before the placement.
///
/// @param notes  gets what became of it that a person would not expect (`Surface::notes`)
[[nodiscard]] Result<TriangleMesh> triangles_of(const SurfaceSpec& spec,
                                                const SurfaceAssets& assets,
                                                std::vector<std::string>* notes = nullptr);

/// What the file of a surface has that the surface has not, and a person would expect: of an
/// outline what its drawing's reader warns of.
[[nodiscard]] std::vector<Warning> target_warnings(const SurfaceSpec& spec,
                                                   const SurfaceAssets& assets);

/// Slices of triangles that already stand in the corner. `closed`: they bound a solid, so that a
/// border that is seen is a hole.
///
/// @retval Infeasible  none of them is in the corner
[[nodiscard]] Result<Surface> surface_of_triangles(TriangleMesh mesh, FitMode fit, const char* what,
                                                   bool closed);

}  // namespace popcut
