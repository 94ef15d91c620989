// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <vector>

#include "core/result.hpp"

namespace popcut {

/// Squared differences of the main text's L_phi for the chain of a quarter circle.
struct AzimuthalError {
  std::vector<double> value;  ///< rad^2
  [[nodiscard]] double mean() const;
};

/// Which points are compared with which angles. The main text's `(phi^j - j Delta phi)^2` is zero
/// at both ends when it is taken as written; its Fig. 2C has the shape of the second.
enum class AzimuthalConvention {
  Vertices,      ///< as printed: vertices j = 0 .. N against j pi / (2 N); N + 1 values
  OuterCorners,  ///< corner (X_i, Z_(i-1)) of unit i against (i - 1/2) pi / (2 N); N values
};

/// L_phi of the optimal chain of `units` units on a quarter circle, angles counted from the wall.
///
/// @retval Infeasible  as `ChainSolver`
[[nodiscard]] Result<AzimuthalError> azimuthal_error(int units, AzimuthalConvention convention);

/// L_j of the optimal chain on the quarter circle of radius 1.
[[nodiscard]] Result<double> quarter_circle_loss(int units);

/// Slope of the straight line that fits log(y) against log(x) best.
[[nodiscard]] double log_log_slope(std::span<const double> x, std::span<const double> y);

}  // namespace popcut
