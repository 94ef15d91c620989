// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>

#include "core/design/spec/spec.hpp"
#include "core/design/target/surface_spec.hpp"
#include "core/result.hpp"

namespace popcut {

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
