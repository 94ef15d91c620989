// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/design/spec/spec.hpp"
#include "core/design/target/surface_spec.hpp"
#include "core/result.hpp"

namespace popcut {

/// Which part of a surface stands in the corner.
enum class Stand {
  Whole,   ///< all of it: its box touches wall and ground
  Quarter  ///< a quarter: the middle of its box lies on the spine
};

/// A point of a surface counts as reached within this share of the diagonal of the surface's box.
inline constexpr double kReachedWithin = 0.02;

/// A proposal and what it reaches.
struct ProposedPlacement {
  TargetPlacement placement;
  bool always_nearest{};  ///< facets: the spec may not say so
  double reached{};       ///< of the whole surface's area, by the structure as designed
  std::optional<double> reached_before{};  ///< the same as the spec stood; none: not designed
  std::string refused_before;              ///< then why
  int tried{};                             ///< ways of standing that were tried
  int refused{};                           ///< better ones by their curves, but not designed
  std::string refusal;                     ///< of the first of those
  double unreachable_share{};              ///< of the outline in the slices of the design
  double rms_mm{}, max_mm{};               ///< of the nearest falling curves there
  double length_mm{};                      ///< of the surface along the spine as it then stands
  double slices_mm{};                      ///< from the first slice's middle to the last one's
};

/// Proposes how a mesh or grid stands in the corner: turned and moved along the spine so that the
/// structure reaches as much of its area as possible, standing as `stand` says. `scale_mm` is kept,
/// but for a surface more than ten times smaller or larger than the slices of a spec without a
/// scale: its unit is not the millimetre, and it is made as long as the slices.
///
/// First by falling curves in 64 strips: the 24 ways to turn it by right angles, then the best of
/// them turned about the spine, then the best of those turned a little about all axes and moved
/// along the spine. The best are designed (with `FitMode::Nearest`) and compared by the area that
/// the structure itself reaches, so what is proposed can be designed.
///
/// @param turns  the turns to choose from, as `TargetPlacement`, and no others near them; none: all
/// @retval OutOfRange  the spec has patches
/// @retval Infeasible  the surface is neither mesh nor grid, no way of standing can be cut, or
///                     none of them can be designed (the detail says why the best cannot)
[[nodiscard]] Result<ProposedPlacement> propose_placement(
    const DesignSpec& spec, const SurfaceAssets& assets, Stand stand = Stand::Whole,
    std::vector<std::array<double, 3>> turns = {});

/// `spec_json` with the placement's fields set and, where it can be, "fit" set to "nearest": ready
/// to be designed.
[[nodiscard]] Result<std::string> with_placement(std::string_view spec_json,
                                                 const ProposedPlacement& proposed);

}  // namespace popcut
