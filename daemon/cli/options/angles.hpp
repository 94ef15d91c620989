// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "core/curvature/samples.hpp"
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

inline constexpr std::size_t kMostSamples = 1'000'000;

/// `A:B:N` as N evenly spaced numbers from A to B with both ends, N from 2 to 10^6. A lone `A` is
/// one value. `option` ("--r") names it in errors.
///
/// @retval Usage  it is none of these, or a number is not finite
[[nodiscard]] Result<Samples> parse_samples(std::string_view option, std::string_view text);

/// The same with angles for A and B (`0:pi:61`, `10deg:90deg:9`), each from 0 (shut) to pi (flat).
[[nodiscard]] Result<Samples> parse_opening_samples(std::string_view option, std::string_view text);

/// What to add to an error about an opening angle where degrees were meant: "; for 90 degrees, give
/// 90deg". Empty where the number cannot be that.
[[nodiscard]] std::string degrees_hint(std::string_view text);

}  // namespace popcut::cli
