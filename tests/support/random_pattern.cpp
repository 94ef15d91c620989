// SPDX-License-Identifier: MIT
#include "tests/support/random_pattern.hpp"
#include "tests/support/paths.hpp"

#include <fstream>
#include <sstream>
#include <stdexcept>

#include <fmt/format.h>

#include "core/design/design.hpp"
#include "tests/support/random_lattice.hpp"

namespace popcut::testing {

// Kept apart from the tests of layouts, whose drawings need not come from a design.
LineWork random_linework(std::mt19937& random, double scale) {
  for (;;) {
    const auto spec = parse_design_spec(random_lattice_spec(random, scale));
    if (!spec) continue;
    if (const auto made = design(*spec)) return linework_from_pattern(made->pattern);
  }
}

namespace {

LineWork designed(const std::string& text, std::size_t& faces) {
  const auto spec = parse_design_spec(text);
  if (!spec) throw std::runtime_error(message(spec.error()));
  const auto made = design(*spec);
  if (!made) throw std::runtime_error(message(made.error()));
  faces = made->pattern.faces();
  return linework_from_pattern(made->pattern);
}

}  // namespace

LineWork lattice_linework(int units, int slices, double width_mm, double size_mm,
                          std::size_t& faces) {
  return designed(
      fmt::format(R"j({{"popcut":1,"surface":{{"type":"revolution","radius":"1.5+0.2*sin(2*y)"}},
                        "scale_mm":{},"units_per_slice":{},"slices":{},"widths_mm":{},
                        "lattice":"slices"}})j",
                  size_mm, units, slices, width_mm),
      faces);
}

LineWork example_linework(const std::string& name, std::size_t& faces) {
  std::ifstream file(popcut::testing::source_file("examples/") + name + ".json");
  std::stringstream text;
  text << file.rdbuf();
  return designed(text.str(), faces);
}

}  // namespace popcut::testing
