// SPDX-License-Identifier: MIT
#pragma once

#include <random>
#include <string>

namespace popcut::testing {

/// A valid spec: a smooth radius or a falling profile, any method, even or uneven widths; `scale`
/// times 25 to 120 mm large. Not all have a pattern: there may be too many units for the size.
std::string random_lattice_spec(std::mt19937& random, double scale = 1.0);

}  // namespace popcut::testing
