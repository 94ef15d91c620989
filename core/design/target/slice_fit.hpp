// SPDX-License-Identifier: MIT
#pragma once

namespace popcut {

/// How much of a target a slice (or a whole design) follows.
struct SliceFit {
  double outline_mm{};      ///< length of the section's boundary in the corner
  double unreachable_mm{};  ///< of it, what no falling curve follows: hidden or moved by the fit
  double visible_mm{};      ///< of it, what is seen from outside the corner
  double rms_mm{};          ///< distance of the seen part from the curve that was taken
  double max_mm{};
};

/// The unreachable part of the boundary, 0 to 1.
[[nodiscard]] inline double unreachable_share(const SliceFit& fit) {
  return fit.outline_mm > 0.0 ? fit.unreachable_mm / fit.outline_mm : 0.0;
}

/// Sums slices: lengths are added, rms is weighted by the seen length.
void accumulate(SliceFit& total, const SliceFit& slice);

}  // namespace popcut
