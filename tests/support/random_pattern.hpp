// SPDX-License-Identifier: MIT
#pragma once

#include <random>
#include <string>

#include "core/drawing/linework.hpp"

namespace popcut::testing {

/// The lines of a random lattice's pattern (`random_lattice_spec`).
LineWork random_linework(std::mt19937& random, double scale);

/// The lines of a `slices` lattice about a wavy radius of 1.5 `size_mm`, and how many faces it has.
LineWork lattice_linework(int units, int slices, double width_mm, double size_mm,
                          std::size_t& faces);

/// The lines of examples/NAME.json.
LineWork example_linework(const std::string& name, std::size_t& faces);

}  // namespace popcut::testing
