// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string_view>

#include "core/curvature/samples.hpp"
#include "core/result.hpp"

namespace popcut::cli {

inline constexpr std::size_t kMostSamples = 1'000'000;

/// `A:B:N` as N evenly spaced numbers from A to B with both ends, N from 2 to 10^6. A lone `A` is
/// one value. `option` ("--r") names it in errors.
///
/// @retval Usage  it is none of these, or a number is not finite
[[nodiscard]] Result<Samples> parse_samples(std::string_view option, std::string_view text);

/// The same with angles for A and B (`0:pi:61`, `10deg:90deg:9`), each from 0 (shut) to pi (flat).
[[nodiscard]] Result<Samples> parse_opening_samples(std::string_view option, std::string_view text);

}  // namespace popcut::cli
