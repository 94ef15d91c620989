// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "core/design/chain/slicing.hpp"
#include "core/design/spec/report.hpp"
#include "core/design/spec/spec.hpp"
#include "core/design/strips/strips.hpp"
#include "core/design/target/curve.hpp"
#include "core/pattern/pattern.hpp"
#include "core/progress.hpp"
#include "core/result.hpp"

namespace popcut {

/// All that a design computes: the strips, the pattern they make, and its figures.
struct Design {
  Strips strips;
  Pattern pattern;
  std::vector<std::int32_t> panel_face;  ///< rigid face of each panel of the strips
  DesignReport report;
  std::vector<TargetPiece> target;  ///< the surface that was asked for, along its own spine
  std::vector<SliceCurve> edges;    ///< of a patch: the target where its neighbours begin
};

/// Target surface to pattern: slices, chains, lattice, strips, cuts and folds (sections 3 and 4).
/// `report.seconds` is left at zero; the caller has the clock.
///
/// @param assets  contents of the files that the spec's surface names (`asset_of`)
/// @retval Malformed   the surface's expression or file cannot be read
/// @retval OutOfRange  it is not finite and positive where a slice or connector needs it; `place`
///                     names the field and s
/// @retval Infeasible  no valid pattern exists for it; `place` names the slice
[[nodiscard]] Result<Design> design(const DesignSpec& spec, const SurfaceAssets& assets = {},
                                    const Progress& progress = {});

}  // namespace popcut
