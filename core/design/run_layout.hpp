// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/design/chain/slicing.hpp"
#include "core/design/lattice/lattice.hpp"
#include "core/design/spec/spec.hpp"
#include "core/design/strips/pattern_builder.hpp"
#include "core/design/strips/strip_builder.hpp"
#include "core/result.hpp"
#include "core/rigid/mobility.hpp"

namespace popcut {

/// The slices as runs between plain cuts, with what each run is aimed at.
struct RunLayout {
  std::vector<LaidSlice> laid;
  std::vector<Run> runs;
  std::vector<RunTarget> targets;                ///< one a run
  std::vector<std::vector<double>> connector_s;  ///< one a run, mm along the spine
  std::vector<BlankSlice> blanks;                ///< slices without structure, in no run
};

/// Runs between plain cuts, their planes still empty; a slice that stands alone becomes two halves,
/// since one strip alone has only every second plane.
///
/// @param cut_after  one a slice: not 0 where a plain cut follows it
[[nodiscard]] RunLayout lay_runs(const Slicing& sliced, const std::vector<std::uint8_t>& cut_after,
                                 const DesignSpec& spec);

/// The smaller of the card's measures that the spec gives, where the shut structure is to lie
/// inside the card; none: it gives none, or the structure may stick out.
[[nodiscard]] std::optional<double> given_side_mm(const DesignSpec& spec);

/// Fills the planes of every run by one method (docs/geometry.md, section 4).
///
/// @retval Infeasible  the conformal lattice has no valid planes
[[nodiscard]] Result<void> fill_planes(RunLayout& layout, LatticeMethod method,
                                       const Progress& progress = {});

/// Marks loose panels of slice strips, to be left out when the strips are laid again; where there
/// are none, those of connectors. Whether any was marked.
[[nodiscard]] bool mark_loose(RunLayout& layout, const Strips& strips, const BuiltPattern& built,
                              const rigid::Mobility& motion);

}  // namespace popcut
