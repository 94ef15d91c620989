// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "core/design/target/curve.hpp"
#include "core/design/target/monotone_fit.hpp"
#include "core/design/target/surface_spec.hpp"
#include "core/result.hpp"

namespace popcut {

struct TriangleSoup;

/// Which part of a target is wanted as triangles, and how finely.
struct TargetStretch {
  double from_mm{}, to_mm{};  ///< along the spine, in the surface's own places
  double reach_x_mm{};        ///< about how far it stands from the wall, X: a first guess
  double reach_z_mm{};        ///< about how high it stands, Z
  double finest_mm{};         ///< chords may stray by this
};

/// A target surface, seen by the design as its slices: for each place s along the spine (mm) the
/// curve that the plane v = s cuts out of it (docs/geometry.md, section 3), in the section's
/// coordinates (X, Z).
///
/// A slice is an error of its own: OutOfRange where the surface is not finite and positive there,
/// Infeasible where it is not in the corner or (FitMode::Exact) its curve does not fall from the
/// wall to the ground; `place` names s.
class Surface {
 public:
  /// Parses expressions and files; what is sliced often is indexed here, once.
  ///
  /// @param assets  contents of the file that the surface names; not kept
  /// @retval Malformed   the expression does not parse, the file is absent or not of its kind
  /// @retval OutOfRange  a value in the file is not valid, or the file is too large
  /// @retval Infeasible  no part of the mesh is in the corner
  [[nodiscard]] static Result<Surface> make(const SurfaceSpec& spec,
                                            const TargetPlacement& placement, FitMode fit,
                                            const SurfaceAssets& assets = {});

  /// The curve with what it leaves out of the target.
  [[nodiscard]] Result<SurfaceSlice> cut(double s_mm) const { return slice_(s_mm); }
  [[nodiscard]] Result<SliceCurve> slice(double s_mm) const {
    auto cut_there = slice_(s_mm);
    if (!cut_there) return tl::unexpected(cut_there.error());
    return std::move(cut_there->curve);
  }

  /// The surface itself in space, mm, not the curves that are fitted to its sections. Of
  /// formulas the part that stands in the corner over the stretch; of meshes and grids all
  /// triangles, but those that lie on wall or ground, which the card makes.
  [[nodiscard]] TriangleSoup triangles(const TargetStretch& stretch) const;

  /// What became of it that a person would not expect, in sentences.
  std::vector<std::string> notes;

  using Slicer = std::function<Result<SurfaceSlice>(double)>;
  using Tessellator = std::function<TriangleSoup(const TargetStretch&)>;
  Surface(Slicer slice, Tessellator tessellate)
      : slice_(std::move(slice)), tessellate_(std::move(tessellate)) {}

 private:
  Slicer slice_;
  Tessellator tessellate_;
};

}  // namespace popcut
