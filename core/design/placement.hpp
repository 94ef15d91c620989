// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <string>

#include "core/design/spec.hpp"
#include "core/design/surface_spec.hpp"
#include "core/design/triangle_mesh.hpp"
#include "core/result.hpp"

namespace popcut {

/// No turn, and no shift but along the spine: the slices of an upright surface stay its own.
[[nodiscard]] bool stays_upright(const TargetPlacement& placement);

/// A placement as a map: points of the surface (its own units) to the corner (mm) and back.
class PlacementMap {
 public:
  explicit PlacementMap(const TargetPlacement& placement);
  [[nodiscard]] std::array<double, 3> to_corner(const std::array<double, 3>& q) const;
  [[nodiscard]] std::array<double, 3> to_surface(const std::array<double, 3>& p) const;

 private:
  std::array<std::array<double, 3>, 3> turn_;  ///< rows; exact for multiples of 90 degrees
  double scale_;
  std::array<double, 3> shift_;
};

/// The mesh in the corner, mm.
///
/// @retval OutOfRange  a coordinate is farther than a kilometre from the corner
[[nodiscard]] Result<TriangleMesh> placed(TriangleMesh mesh, const TargetPlacement& placement);

/// Which part of a surface stands in the corner.
enum class Stand {
  Whole,   ///< all of it: its box touches wall and ground
  Quarter  ///< a quarter: the middle of its box lies on the spine
};

/// A proposal and what it reaches.
struct ProposedPlacement {
  TargetPlacement placement;
  double unreachable_share{};  ///< of the outline in the slices that were tried
  double rms_mm{}, max_mm{};   ///< of the nearest falling curves there
  double length_mm{};          ///< of the surface along the spine as it then stands
  double slices_mm{};          ///< from the first slice's middle to the last one's
};

/// Proposes how a mesh or grid stands in the corner: of the 24 ways to turn it by right angles the
/// one of which falling curves reach most (in nine sections), standing as `stand` says, its
/// middle along the spine at the middle of the slices; `scale_mm` is kept.
///
/// @retval Infeasible  the surface is neither mesh nor grid, or no way of standing can be cut
[[nodiscard]] Result<ProposedPlacement> propose_placement(const DesignSpec& spec,
                                                          const SurfaceAssets& assets,
                                                          Stand stand = Stand::Whole);

/// `spec_json` with the placement's fields set, and "fit" to "nearest" where something is out of
/// reach: ready to be designed.
[[nodiscard]] Result<std::string> with_placement(std::string_view spec_json,
                                                 const ProposedPlacement& proposed);

}  // namespace popcut
