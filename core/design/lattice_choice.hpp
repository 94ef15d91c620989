// SPDX-License-Identifier: MIT
#pragma once

#include <array>

#include "core/design/chain/slicing.hpp"
#include "core/design/spec/report.hpp"
#include "core/design/spec/spec.hpp"
#include "core/design/strips/strips.hpp"
#include "core/fit/fit.hpp"
#include "core/pattern/pattern.hpp"

namespace popcut {

/// What `"lattice": "auto"` chooses from; of equals the first is taken.
inline constexpr std::array kLatticesToTry{LatticeMethod::Slices, LatticeMethod::Branching,
                                           LatticeMethod::Levels, LatticeMethod::Conformal,
                                           LatticeMethod::Direct};

/// What solving all planes together may cost, in slices times units^3: beyond it, some ten seconds.
/// The conformal lattice is left out then; `direct` has been nearer wherever both were laid.
inline constexpr double kMostConformalWork = 1.5e8;

/// Measures lattices of one design, as they are laid, against its target: the distance in space
/// between their panels (without wall and ground) and the surface through the sections of all
/// slices and connectors, both ways (`FitTarget`).
class LatticeRanking {
 public:
  /// @param strips  of any of the lattices: where the slices lie along the spine
  /// @param design_psi_rad  opening angle at which they show the target
  LatticeRanking(const Slicing& sliced, const Strips& strips, double design_psi_rad);

  /// Writes the trial's figures.
  void measure(const Strips& strips, LatticeTrial& trial) const;

 private:
  FitTarget target_;
  Pattern opened_;  ///< without faces: how far it is opened
};

}  // namespace popcut
