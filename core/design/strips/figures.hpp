// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "core/design/spec/report.hpp"
#include "core/design/strips/strip_builder.hpp"

namespace popcut {

/// A place along the target and its curve there.
struct TargetStation {
  double s_mm{};
  const SliceCurve* curve{};
};

/// What the figures of a lattice are measured against.
struct FigureInput {
  const Strips& strips;
  std::vector<TargetStation> slices;      ///< one a slice or box strip, in the order of the strips
  std::vector<TargetStation> connectors;  ///< one for each connector strip
  std::vector<bool> left_parity;  ///< of each connector: its left slice is an odd one of its run
  double mean_step_mm{};
  DesignAngle opening{};  ///< that the target was made for: distances are those in space there
};

/// Measures a lattice as it is laid (docs/geometry.md, section 4: "exact is not yet
/// good"). Fold vertices are the middles of the connectors' valley folds with their wall and ground
/// ends; a lattice without connectors has those of its slices.
[[nodiscard]] LatticeFigures measure(const FigureInput& input);

}  // namespace popcut
