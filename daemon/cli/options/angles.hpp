// SPDX-License-Identifier: MIT
#pragma once

#include <string_view>
#include <vector>

#include "core/result.hpp"

namespace popcut::cli {

/// An angle as people write it, in rad: `1.1`, `pi`, `pi/2`, `0.4pi`, `2*pi/3`, or `90deg`.
///
/// @retval Usage  it is none of these
[[nodiscard]] Result<double> parse_angle(std::string_view text);

/// Opening angles with commas between them, each of 0 (shut) to pi (flat); empty text has none.
///
/// @retval Usage  one of them is no such angle
[[nodiscard]] Result<std::vector<double>> parse_opening_angles(std::string_view text);

}  // namespace popcut::cli
