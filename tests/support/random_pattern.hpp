// SPDX-License-Identifier: MIT
#pragma once

#include <random>

#include "core/plan/linework.hpp"

namespace popcut::test {

/// The lines of a random lattice's pattern (`random_lattice_spec`).
LineWork random_linework(std::mt19937& random, double scale);

}  // namespace popcut::test
