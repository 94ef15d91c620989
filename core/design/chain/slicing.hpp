// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/design/chain/chain.hpp"
#include "core/design/spec/report.hpp"
#include "core/design/spec/spec.hpp"
#include "core/design/target/curve.hpp"
#include "core/design/target/surface.hpp"
#include "core/design/target/surface_spec.hpp"
#include "core/progress.hpp"
#include "core/result.hpp"

namespace popcut {

/// A stretch of the target with a surface of its own; the one surface of most designs is all of it.
struct TargetPiece {
  Surface surface;
  double origin_mm{};  ///< where the surface's own place 0 lies along the target
  double from_mm{-std::numeric_limits<double>::infinity()};
  double to_mm{std::numeric_limits<double>::infinity()};
};

/// The slices of a design with their chains, before any lattice (docs/geometry.md, section 3). All
/// lists have one entry a slice but for the chains, which follow each other.
struct Slicing {
  std::vector<double> s_mm;      ///< middle of the slice along the target
  std::vector<double> width_mm;  ///< w
  std::vector<int> units;        ///< N of its region; 0 where the slice is blank
  /// Why a slice is blank, plain card: the target is not there, or too small for panels. Empty for
  /// all others. A blank slice has a curve of another one and no chain, and plain cuts beside it.
  std::vector<std::string> blank;
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
  std::vector<TargetPiece> pieces;           ///< the target itself
  std::optional<CurvatureReport> curvature;  ///< of augmented chains
  /// Slices whose target ends inside their width: the slice, and the plane that was cut instead.
  std::vector<std::pair<int, double>> moved;
  std::vector<std::string> notes;  ///< of the surface
  int uniform_slices{};            ///< with adaptive widths: equal slices of the same error; else 0

  [[nodiscard]] int slices() const { return static_cast<int>(s_mm.size()); }
  [[nodiscard]] bool is_blank(std::size_t j) const { return !blank[j].empty(); }
};

/// Cuts the target into slices and solves each slice's chain. In a card a slice where the target is
/// not, or too small for panels, stays blank; between two slices such a place is a plain cut.
///
/// @retval OutOfRange  the surface is not finite and positive at a slice or connector
/// @retval Infeasible  a slice's curve does not fall to the ground; all slices are blank, or one
///                     without a card or at the edge of a patch is
[[nodiscard]] Result<Slicing> slice_target(const DesignSpec& spec, const SurfaceAssets& assets,
                                           const Progress& progress = {});

}  // namespace popcut
