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

}  // namespace popcut
