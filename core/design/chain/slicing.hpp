// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "core/design/chain/chain.hpp"
#include "core/design/spec/report.hpp"
#include "core/design/spec/spec.hpp"
#include "core/design/target/curve.hpp"
#include "core/design/target/surface_spec.hpp"
#include "core/result.hpp"

namespace popcut {

/// The slices of a design with their chains, before any lattice (docs/geometry.md, section 3). All
/// lists have one entry a slice but for the chains, which follow each other.
struct Slicing {
  std::vector<double> s_mm;      ///< middle of the slice along the target
  std::vector<double> width_mm;  ///< w
  std::vector<int> units;        ///< N of its region
  std::vector<SliceCurve> curves;
  std::vector<double> between_s_mm;     ///< middle of the connector after the slice
  std::vector<SliceCurve> between;      ///< the target there; one less than slices
  std::vector<std::uint8_t> cut_after;  ///< 1: the next slice has another N, so a plain cut follows
  std::vector<std::size_t> chain_first;  ///< slices + 1 offsets into the chains
  std::vector<double> chain_x, chain_z;  ///< units + 1 vertices a slice
  std::vector<ChainFigures> figures;
  std::vector<SliceFit> fits;  ///< what each slice leaves out of the target
  /// Of a patch: the target at its two edges, half a width beyond the outer slices' middles; the
  /// slice's own curve where the target ends before.
  std::vector<SliceCurve> edges;
  std::optional<CurvatureReport> curvature;  ///< of augmented chains
  /// Slices whose target ends inside their width: the slice, and the plane that was cut instead.
  std::vector<std::pair<int, double>> moved;
  int uniform_slices{};  ///< with adaptive widths: equal slices of the same error; else 0

  [[nodiscard]] int slices() const { return static_cast<int>(s_mm.size()); }
};

/// Cuts the target into slices and solves each slice's chain.
///
/// @retval OutOfRange  the surface is not finite and positive at a slice or connector
/// @retval Infeasible  a slice's curve does not fall to the ground, or leaves no room for panels
[[nodiscard]] Result<Slicing> slice_target(const DesignSpec& spec, const SurfaceAssets& assets);

}  // namespace popcut
