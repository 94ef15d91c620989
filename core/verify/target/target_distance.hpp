// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

namespace popcut {

/// Distances of fold vertices from the target surface, in mm.
struct TargetDistance {
  std::size_t vertices{};
  double rms_mm{};
  double max_mm{};
};

/// The distances of a pattern: of its inner fold vertices, and of all with the ends at wall and
/// ground.
struct TargetDistances {
  TargetDistance inner, all;
};

}  // namespace popcut
