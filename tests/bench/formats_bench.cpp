// SPDX-License-Identifier: MIT
#include <sstream>

#include <catch2/catch.hpp>

#include "core/formats/fold/fold_writer.hpp"
#include "core/formats/write/pattern_files.hpp"
#include "core/picture/deployed_svg.hpp"
#include "tests/support/box_card.hpp"

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

}  // namespace formats_bench
