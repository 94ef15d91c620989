// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/design/spec/spec.hpp"
#include "core/design/target/curve.hpp"
#include "core/progress.hpp"
#include "core/result.hpp"

namespace popcut {

/// What the lattice of one run of slices aims at: everything between two plain cuts or margins.
struct RunTarget {
  int units{};                               ///< N
  std::vector<SliceCurve> slice_curves;      ///< one a slice
  std::vector<SliceCurve> connector_curves;  ///< one between neighbours, at the connector's middle
  std::vector<double> chain_x, chain_z;      ///< slices x (N + 1), the optimised chains
  std::vector<double> slice_s_mm, slice_width_mm;  ///< one a slice: its middle, its w
  std::vector<double> connector_s_mm;              ///< one for each connector
  double min_panel_mm{};
  std::optional<double> max_step_over_mean;
  /// Largest X + Z of a corner, its distance from the spine when the card is shut; none: no limit.
  /// Only `lattice_direct` keeps it.
  std::optional<double> shut_reach_mm;

  [[nodiscard]] int slices() const { return static_cast<int>(slice_curves.size()); }
  [[nodiscard]] std::size_t at(int slice, int level) const {
    return static_cast<std::size_t>(slice) * static_cast<std::size_t>(units + 1) +
           static_cast<std::size_t>(level);
  }
  /// Mean step of the target, (d + h) / 2 N over the connectors (or slices), mm.
  [[nodiscard]] double mean_step() const;
};

/// The planes of a run: one number a slice and level (docs/geometry.md, section 4). Slice `j` holds
/// the height Z of level `i` where i + j is even, else the offset X. X = 0 is the wall and Z = 0
/// the ground: a plane with that value has ended there.
struct Planes {
  int units{};
  std::vector<double> value;  ///< slices x (N + 1)

  [[nodiscard]] int slices() const {
    return static_cast<int>(value.size() / static_cast<std::size_t>(units + 1));
  }
  [[nodiscard]] static bool holds_height(int slice, int level) {
    return ((slice + level) & 1) == 0;
  }
  [[nodiscard]] double& at(int slice, int level) {
    return value[static_cast<std::size_t>(slice) * static_cast<std::size_t>(units + 1) +
                 static_cast<std::size_t>(level)];
  }
  [[nodiscard]] double at(int slice, int level) const {
    return const_cast<Planes*>(this)->at(slice, level);
  }
  /// The vertex of level `level` on the connector between `left` and the next slice.
  [[nodiscard]] SectionPoint vertex(int left, int level) const {
    return holds_height(left, level) ? SectionPoint{at(left + 1, level), at(left, level)}
                                     : SectionPoint{at(left, level), at(left + 1, level)};
  }
};

/// Every slice takes its planes from its own chain. O(units).
[[nodiscard]] Planes lattice_slices(const RunTarget& target);

/// The paper's protocol (S2.C): slices go in pairs, and level i of a pair takes both coordinates
/// from the chain of its even slice for even i, of its odd slice for odd i.
[[nodiscard]] Planes lattice_branching(const RunTarget& target);

/// Newton steps that a conformal lattice took, and its unknowns, for benchmarks.
struct ConformalEffort {
  int steps{};
  int unknowns{};
};

/// Popcut's own: pulls every connector vertex onto the surface by Gauss-Newton with log barriers
/// (docs/geometry.md, section 4), the smallest step at least `min_panel_mm`.
///
/// @param give_up_over_mean  stop early, with what there is, once exactness would need a longer
/// step
/// @retval Infeasible  no lattice with steps of at least `min_panel_mm` exists, even with equal
/// steps
[[nodiscard]] Result<Planes> lattice_conformal(
    const RunTarget& target, std::optional<double> give_up_over_mean = std::nullopt,
    ConformalEffort* effort = nullptr, const Progress& progress = {});

/// Newton steps that a direct lattice took, and its unknowns, for benchmarks.
struct DirectEffort {
  int steps{};
  int unknowns{};
};

/// Minimises what is seen: the squared distance of all panels from the target (`PanelError`), with
/// steps of at least `min_panel_mm` (docs/geometry.md, section 4). Levels may end at wall and
/// ground as those of `lattice_levels` do.
///
/// Needs `slice_s_mm`, `slice_width_mm` and `connector_s_mm`. Where no planes keep `min_panel_mm`,
/// the steps are as long as they can be, and those that are too short are left out later on. Keeps
/// `shut_reach_mm` where that leaves steps of `min_panel_mm`; else pays no heed to it.
///
/// @retval OutOfRange  the matrix would be too large
[[nodiscard]] Result<Planes> lattice_direct(const RunTarget& target, DirectEffort* effort = nullptr,
                                            const Progress& progress = {});

/// Exact in O(units): levels end and begin at wall and ground (docs/geometry.md, section 4).
///
/// @param power  none: levels at equal angles on the largest section. Else at places (x/d)^2 -
///               (z/h)^2 = sign(q) |q|^power, q = 2 i/N - 1: the larger, the more of them are left
///               where the target is smaller
[[nodiscard]] Planes lattice_levels(const RunTarget& target,
                                    std::optional<double> power = std::nullopt);

}  // namespace popcut
