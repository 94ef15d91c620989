// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>

#include "core/design/target/curve.hpp"

namespace popcut::testing {

/// Largest distance of points of one curve from another, mm.
[[nodiscard]] inline double apart(const SliceCurve& a, const SliceCurve& b) {
  double most = std::max(std::abs(a.h() - b.h()), std::abs(a.d() - b.d()));
  for (int k = 0; k <= 100; ++k) {
    const CurveJet p = a.at(-1.0 + 0.02 * k);
    most = std::max(most, b.nearest_distance({p.x, p.z}));
  }
  return most;
}

}  // namespace popcut::testing
