// SPDX-License-Identifier: MIT
#include <algorithm>
#include <chrono>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "core/design/design.hpp"
#include "core/design/strips/multi_state.hpp"
#include "core/formats/fold/fold_writer.hpp"
#include "core/verify/verify.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/timing.hpp"
#include "tests/support/value.hpp"

using namespace popcut;
using namespace popcut::testing;

namespace {

DesignSpec example(const std::string& name) {
  std::ifstream file(source_file("examples/") + name + ".json");
  std::stringstream text;
  text << file.rdbuf();
  return value(parse_design_spec(text.str()));
}

std::string fold_of(const Design& made) {
  std::ostringstream out;
  REQUIRE(write_fold(made.pattern, {}, out));
  return out.str();
}

}  // namespace

TEST_CASE("the composite of Fig. 3A", "[bench]") {
  const DesignSpec spec = example("composite");
  Design made;
  const double designed = median_of(21, [&] { made = value(design(spec)); });
  std::string fold;
  const double written = median_of(21, [&] { fold = fold_of(made); });
  const double verified = median_of(5, [&] { REQUIRE(verify_fold(fold)->ok()); });
  fmt::print(
      "composite of Fig. 3A, {} slices, {} folds: designed in {:.1f} ms, FOLD in {:.1f} ms, "
      "verified "
      "in {:.1f} ms (medians)\n",
      made.report.slices.size(), made.report.folds, 1e3 * designed, 1e3 * written, 1e3 * verified);
}

TEST_CASE("the multi-state solve of Fig. 3D", "[bench]") {
  const DesignSpec spec = example("multistate");
  DesignSpec plain = spec;
  plain.splay.reset();
  const auto made = value(design(plain));
  MultiState state;
  const double solved =
      median_of(11, [&] { state = value(solve_multi_state(made.strips, *spec.splay)); });
  std::string reached;
  for (const double K : state.K_rad) reached += fmt::format(" {:+.4f}", K);
  const double whole = median_of(11, [&] { REQUIRE(design(spec)); });
  fmt::print(
      "multi-state, three openings: alphas solved in {:.1f} ms, with its design {:.1f} ms "
      "(medians); K ={} rad\n",
      1e3 * solved, 1e3 * whole, reached);
}

TEST_CASE("chains with curvature asked for", "[bench]") {
  for (const auto& [units, slices] : {std::pair{6, 8}, std::pair{12, 24}, std::pair{20, 60}}) {
    const auto spec = value(parse_design_spec(fmt::format(
        R"j({{"popcut":1,"surface":{{"type":"revolution","radius":"sqrt(40^2+(y-30)^2)"}},
              "units_per_slice":{},"slices":{},"widths_mm":{},
              "curvature":{{"K_area":-0.000625,"weights":{{"K":100}}}},"min_panel_mm":0.01}})j",
        units, slices, 64.0 / slices)));
    CurvatureReport report;
    const double seconds = median_of(units < 20 ? 5 : 1, [&] {
      auto made = value(design(spec));
      report = *made.report.curvature;
    });
    fmt::print(
        "curvature on {} units x {} slices: {:.3f} s (median), {} evaluations; K's miss {:.3g} "
        "-> {:.3g} /mm^2 rms\n",
        units, slices, seconds, report.evaluations, report.figures.front().plain_miss.rms,
        report.figures.front().miss.rms);
  }
}
