// SPDX-License-Identifier: MIT
#include <sstream>

#include <catch2/catch.hpp>

#include "core/formats/fold/fold_writer.hpp"
#include "core/formats/lattice/lattice_blob.hpp"
#include "core/formats/write/pattern_files.hpp"
#include "core/picture/deployed_svg.hpp"
#include "tests/support/box_card.hpp"
#include "tests/support/value.hpp"

namespace formats_bench {

using namespace popcut;

TEST_CASE("writing a pattern of 200 000 faces and 800 000 vertices", "[.][bench][formats]") {
  const Pattern pattern = testing::row_of_boxes(100'000);
  REQUIRE(pattern.faces() == 200'002);
  BENCHMARK("FOLD with three deployed frames") {
    std::ostringstream out;
    return write_fold(pattern, {}, out) ? out.str().size() : 0;
  };
  BENCHMARK("pattern.svg") {
    std::ostringstream out;
    write_pattern_svg(pattern, out);
    return out.str().size();
  };
  BENCHMARK("deployed.svg") {
    std::ostringstream out;
    write_deployed_svg(card_scene(pattern), 1.5, {}, out);
    return out.str().size();
  };
}

TEST_CASE("the lattice blob of 10 000 panels", "[.][bench][formats]") {
  const auto spec =
      testing::value(parse_design_spec(R"j({"popcut": 1, "surface": {"type": "revolution",
    "radius": "sqrt(3600 - y^2/4)"}, "translate_mm": [0, 100, 0], "units_per_slice": 50,
    "slices": 100, "widths_mm": 2, "min_panel_mm": 0.05, "lattice": "levels"})j"));
  const auto made = testing::value(design(spec));
  REQUIRE(made.report.panels > 9000);
  const auto bytes = [&](const LatticeBlobOptions& options) {
    const auto blob = lattice_blob(made, options);
    return blob ? blob->size() : 0;
  };
  BENCHMARK("as it is") { return bytes({.error = false}); };
  BENCHMARK("with the distance of each face from the target") { return bytes({}); };
  BENCHMARK("with K and H") { return bytes({.error = false, .curvature = true}); };
  BENCHMARK("with a ghost of 4000 triangles") {
    return bytes({.error = false, .most_ghost_triangles = 4000});
  };
}

}  // namespace formats_bench
