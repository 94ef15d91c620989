// SPDX-License-Identifier: MIT
// The surfaces of specs as the verifier reads them, against those that the designer slices.
#include <cmath>
#include <string>

#include <catch2/catch.hpp>

#include "core/design/design.hpp"
#include "core/design/shape_fit.hpp"
#include "core/fit/fit.hpp"
#include "core/verify/target/target.hpp"
#include "tests/support/value.hpp"

namespace spec_surface_test {

using namespace popcut;
using Catch::WithinRel;

namespace {

TriangleSoup soup_of(const TriangleMesh& triangles) {
  TriangleSoup soup;
  soup.corners.assign(triangles.corners.begin(), triangles.corners.end());
  return soup;
}

}  // namespace

TEST_CASE("the verifier's triangles of a surface are those of the designer", "[core][compare]") {
  for (const std::string surface :
       {R"j({"type":"revolution","radius":"sqrt(36-(y-2)^2)"})j",
        R"j({"type":"revolution","radius":"5+0.1*y"},"design_angle_deg":60)j",
        R"j({"type":"profile","z":"4-x^2/4+0.02*y"})j",
        R"j({"type":"implicit","f":"x^2+z^2+(y-3)^2-49"})j",
        R"j({"type":"profile","z":{"points":[[0,5],[2,4],[4,2],[5,0]]}})j",
        R"j({"type":"loft","stations":[{"y":-1,"curve":[[0,5],[3,3],[5,0]]},
            {"y":8,"curve":[[0,4],[4,3],[6,0]]}]})j"}) {
    const std::string spec_text =
        R"({"popcut":1,"units_per_slice":4,"slices":8,"widths_mm":8,"scale_mm":10,"surface":)" +
        surface + "}";
    CAPTURE(spec_text);
    const auto made = testing::value(design(testing::value(parse_design_spec(spec_text)), {}));
    std::vector<double> s_mm;
    for (const SliceReport& slice : made.report.slices) s_mm.push_back(slice.s_mm);
    const SpineMap along(made.strips, s_mm);
    const TriangleSoup theirs = target_triangles(made.strips, along, made.report, made.target);
    const auto target = testing::value(verify::read_target(spec_text));
    double from = INFINITY, to = -INFINITY, x = 0.0, z = 0.0;
    for (std::size_t k = 0; k < theirs.corners.size(); k += 3) {
      from = std::min(from, theirs.corners[k + 1]), to = std::max(to, theirs.corners[k + 1]);
      x = std::max(x, theirs.corners[k]), z = std::max(z, theirs.corners[k + 2]);
    }
    TriangleMesh triangles;
    target.surface->add_triangles({from, to, x, z}, triangles);
    const TriangleSoup ours = soup_of(triangles);
    CHECK_THAT(area_of(ours), WithinRel(area_of(theirs), 0.01));
    const FitTarget aim(theirs);
    const FitFigures off = aim.measure(ours);
    // Both are chords of the same surface, each within a few thousandths of its size.
    CHECK(off.to_target.mean_mm < 2e-3 * off.size_mm);
    CHECK(off.to_structure.mean_mm < 2e-3 * off.size_mm);
    CHECK(off.to_structure.p95_mm < 1e-2 * off.size_mm);
  }
}

}  // namespace spec_surface_test
