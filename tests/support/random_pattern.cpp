// SPDX-License-Identifier: MIT
#include "tests/support/random_pattern.hpp"

#include "core/design/design.hpp"
#include "tests/support/random_lattice.hpp"

namespace popcut::test {

// Kept apart from the tests of layouts, whose drawings need not come from a design.
LineWork random_linework(std::mt19937& random, double scale) {
  for (;;) {
    const auto spec = parse_design_spec(random_lattice_spec(random, scale));
    if (!spec) continue;
    if (const auto made = design(*spec)) return linework_from_pattern(made->pattern);
  }
}

}  // namespace popcut::test
