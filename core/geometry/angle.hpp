// SPDX-License-Identifier: MIT
#pragma once

#include <numbers>

namespace popcut {

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kDegrees = 180.0 / kPi;  ///< degrees of one radian

}  // namespace popcut
