// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <vector>

#include "core/design/chain/slicing.hpp"
#include "core/design/lattice/lattice.hpp"
#include "core/design/spec/report.hpp"
#include "core/design/spec/spec.hpp"
#include "core/result.hpp"

namespace popcut {

/// Replaces the plain chains of `slicing` by those of the augmented loss (S4), run by run: slices
/// between two plain cuts, three or more of two units or more. Other runs keep their plain chains.
/// Writes what was reached to `slicing.curvature`.
///
/// @retval Infeasible  no run has inner vertices, or the curvature is nowhere finite
/// @retval OutOfRange  a list of targets is not as long as there are inner vertices, or these are
///                     more than `kMostAugmented`
[[nodiscard]] Result<void> augment_chains(const AugmentedSpec& spec, Slicing& slicing);
inline constexpr std::size_t kMostAugmented = 20'000;

/// Where a run of the finished lattice took its slices from.
struct PlacedPlanes {
  const Planes* planes{};
  std::vector<int> slice;           ///< of the slicing, one a slice of the planes
  std::vector<double> connector_s;  ///< middles of its connectors, mm; empty: it has none
};

/// Adds what K and H are at the lattice's own fold vertices, the middles of its connectors, against
/// the mean of the targets of the slices beside them.
void measure_lattice(const AugmentedSpec& spec, const std::vector<PlacedPlanes>& runs,
                     CurvatureReport& report);

/// What became of the requested curvature, in sentences for the report.
[[nodiscard]] std::vector<std::string> curvature_notes(const CurvatureReport& report,
                                                       LatticeMethod method);

}  // namespace popcut
