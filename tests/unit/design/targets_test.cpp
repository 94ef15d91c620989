// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "core/design/chain/chain.hpp"
#include "core/design/design.hpp"
#include "core/design/placement.hpp"
#include "core/design/reached_share.hpp"
#include "core/design/target/even_sections.hpp"
#include "core/design/target/expression.hpp"
#include "core/design/target/mesh_slicer.hpp"
#include "core/design/target/placement_map.hpp"
#include "core/design/target/surface.hpp"
#include "core/formats/write/report_json.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/rounds.hpp"
#include "tests/support/slice_distance.hpp"
#include "tests/support/value.hpp"

namespace targets_test {

using namespace popcut;
using namespace popcut::testing;

namespace {

Result<Surface> surface(const SurfaceSpec& spec, const SurfaceAssets& assets = {},
                        const TargetPlacement& placement = {}, FitMode fit = FitMode::Exact) {
  return Surface::make(spec, placement, fit, assets);
}

SurfaceSlice cut(const Result<Surface>& from, double s) {
  if (!from) FAIL(message(from.error()));
  return value(from->cut(s));
}

Result<Surface> mesh_surface(const TriangleMesh& mesh, const TargetPlacement& placement = {},
                             FitMode fit = FitMode::Exact) {
  return surface(MeshSpec{"part.stl"}, {{"part.stl", binary_stl(mesh)}}, placement, fit);
}

std::string spec_text(const std::string& surface_json, const std::string& more = "") {
  return fmt::format(R"({{"popcut": 1, "surface": {}, "units_per_slice": 4, "slices": 6,
                          "widths_mm": 8{}}})",
                     surface_json, more);
}

DesignSpec spec_of(const std::string& surface_json, const std::string& more = "") {
  return value(parse_design_spec(spec_text(surface_json, more)));
}

const std::string kMesh = R"({"type": "mesh", "file": "part.stl"})";

}  // namespace

TEST_CASE("a solid given by its sign has the same slices as the equal revolution",
          "[core][target]") {
  const auto solid = surface(ImplicitSpec{"x^2 + y^2 + z^2 - 1.05"}, {}, {60.0, {}, {}});
  const auto revolution = surface(RevolutionSpec{"sqrt(1.05 - y^2)"}, {}, {60.0, {}, {}});
  for (const double s : {0.0, 10.0, 40.0}) {
    CHECK(apart(cut(solid, s).curve, cut(revolution, s).curve) < 1e-9);
    CHECK(cut(solid, s).fit.unreachable_mm == 0.0);
  }
}

TEST_CASE("the published profiles can be written as formulas", "[core][target]") {
  struct Row {
    const char* name;
    const char* z;  ///< the profile
    const char* f;  ///< the same as a solid
    double h, d;
  };
  const Row row = GENERATE(
      Row{"cylinder", "sqrt(1 - x^2)", "x^2 + z^2 - 1", 1, 1},
      Row{"sphere", "sqrt(1.2 - y^2 - x^2)", "x^2 + y^2 + z^2 - 1.2", std::sqrt(1.11),
          std::sqrt(1.11)},
      Row{"saddle", "sqrt(1 + y^2 - x^2)", "x^2 + z^2 - 1 - y^2", std::sqrt(1.09), std::sqrt(1.09)},
      Row{"concave arc", "1 - sqrt(2*x - x^2)", "x < 1 && z < 1 ? 1 - (1-x)^2 - (1-z)^2 : 1", 1, 1},
      Row{"ellipse", "1.5*sqrt(1 - (x/2)^2)", "(x/2)^2 + (z/1.5)^2 - 1", 1.5, 2},
      Row{"superellipse", "(1 - x^3)^(1/3)", "x^3 + z^3 - 1", 1, 1});
  CAPTURE(row.name);
  const auto profile = surface(ProfileSpec{row.z}, {}, {40.0, {}, {}});
  const SurfaceSlice of_profile = cut(profile, 0.3 * 40.0);
  CHECK_THAT(of_profile.curve.h(), Catch::WithinAbs(40.0 * row.h, 1e-8));
  CHECK_THAT(of_profile.curve.d(), Catch::WithinAbs(40.0 * row.d, 1e-6));
  const SurfaceSlice of_solid = cut(surface(ImplicitSpec{row.f}, {}, {40.0, {}, {}}), 0.3 * 40.0);
  CHECK(apart(of_solid.curve, of_profile.curve) < 2e-3);
  ChainSolver solver;
  std::vector<double> x(8), z(8);
  REQUIRE(solver.solve(of_profile.curve, 7, x, z));
}

TEST_CASE("a mesh of a sphere has the slices of the sphere", "[core][target]") {
  const TriangleMesh ball = icosphere(50.0, 5);
  const auto surface = mesh_surface(ball);
  for (const double s : {0.0, 20.0, -31.0, 45.0}) {
    CAPTURE(s);
    const SurfaceSlice slice = cut(surface, s);
    const double r = std::sqrt(2500.0 - s * s);
    CHECK(apart(slice.curve, SliceCurve(r, r)) < 0.05);  // the facets' own distance
    CHECK(slice.fit.unreachable_mm < 1e-6 * slice.fit.outline_mm);
  }
}

TEST_CASE("slices at a mesh's own planes and corners are whole", "[core][target]") {
  const auto surface = mesh_surface(box_mesh({-10, 0, -10}, {30, 40, 20}, false));
  for (const double s : {0.0, 20.0, 40.0}) {
    const SurfaceSlice slice = cut(surface, s);
    CHECK_THAT(slice.curve.h(), Catch::WithinAbs(20.0, 1e-4));
    CHECK_THAT(slice.curve.d(), Catch::WithinAbs(30.0, 1e-4));
  }
}

TEST_CASE("parts that no falling curve reaches are refused or measured", "[core][target]") {
  // A ball that floats in the corner: only its outer quarter falls, and the nearest curve cuts some
  // of that off to come nearer to the rest that is seen.
  const TargetPlacement floating{1.0, {}, {30, 0, 30}};
  const TriangleMesh ball = icosphere(20.0, 4);
  const auto refused = mesh_surface(ball, floating)->cut(0.0);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().kind == ErrorKind::Infeasible);
  CHECK(refused.error().place == "/surface at s = 0 mm");
  CHECK(refused.error().detail.find("\"fit\": \"nearest\"") != std::string::npos);

  const SurfaceSlice taken = cut(mesh_surface(ball, floating, FitMode::Nearest), 0.0);
  const double share = unreachable_share(taken.fit);
  CHECK(share > 0.75);
  CHECK(share < 0.90);
  CHECK(taken.fit.max_mm < 10.0);
  CHECK(taken.fit.rms_mm < taken.fit.max_mm);
  CHECK(taken.curve.h() > 45.0);
  CHECK(taken.curve.h() < 50.01);
}

TEST_CASE("a ring in the corner hides its inner side", "[core][target]") {
  const auto ring = mesh_surface(torus(40.0, 10.0, 96), {1.0, {90, 0, 0}, {}}, FitMode::Nearest);
  const SurfaceSlice slice = cut(ring, 0.0);  // an annulus from 30 to 50 about the spine
  CHECK_THAT(unreachable_share(slice.fit), Catch::WithinAbs(3.0 / 8.0, 0.01));
  CHECK_THAT(slice.curve.h(), Catch::WithinAbs(50.0, 0.1));
  CHECK(slice.fit.max_mm < 0.1);
}

TEST_CASE("a rising profile is refused with its place or accepted with its error",
          "[core][target]") {
  const ProfileSpec wavy{"1 - x + 0.2*sin(4*pi*x)"};
  const auto refused = surface(wavy, {}, {50.0, {}, {}})->cut(10.0);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().kind == ErrorKind::Infeasible);
  const SurfaceSlice taken = cut(surface(wavy, {}, {50.0, {}, {}}, FitMode::Nearest), 10.0);
  CHECK(taken.fit.unreachable_mm > 0.2 * taken.fit.outline_mm);
  CHECK(taken.fit.max_mm > 1.0);
  CHECK(taken.fit.max_mm < 10.0);
  for (int k = 0; k <= 200; ++k) {
    const CurveJet p = taken.curve.at(-1.0 + 0.01 * k);
    CHECK(p.dx >= -1e-9);
    CHECK(p.dz <= 1e-9);
  }
}

TEST_CASE("turned and shifted solids are the same solids", "[core][target]") {
  // The same cone along y, and along x and then turned about z.
  const auto upright = surface(ImplicitSpec{"x^2 + z^2 - 4 - 0.1*y"}, {}, {10.0, {}, {}});
  const auto lying = surface(ImplicitSpec{"y^2 + z^2 - 4 - 0.1*(-x)"}, {}, {10.0, {0, 0, -90}, {}});
  CHECK(apart(cut(upright, 7.0).curve, cut(lying, 7.0).curve) < 1e-9);
  const auto shifted = surface(RevolutionSpec{"2 + 0.1*y"}, {}, {10.0, {}, {0, 5, 0}});
  CHECK_THAT(cut(shifted, 7.0).curve.h(), Catch::WithinAbs(20.2, 1e-12));
  const auto sunk = surface(RevolutionSpec{"2"}, {}, {10.0, {}, {-5, 0, 0}});
  CHECK_THAT(cut(sunk, 0.0).curve.d(), Catch::WithinAbs(15.0, 1e-9));
  CHECK_THAT(cut(sunk, 0.0).curve.h(), Catch::WithinAbs(std::sqrt(400.0 - 25.0), 1e-9));
}

TEST_CASE("a placement and its inverse cancel", "[core][target]") {
  const PlacementMap map({2.5, {30, -45, 170}, {1, -2, 3}});
  const auto back = map.to_surface(map.to_corner({0.3, -0.7, 1.1}));
  CHECK_THAT(back[0], Catch::WithinAbs(0.3, 1e-14));
  CHECK_THAT(back[1], Catch::WithinAbs(-0.7, 1e-14));
  CHECK_THAT(back[2], Catch::WithinAbs(1.1, 1e-14));
  // x, then y, then z: a turn about x takes y to z, the one about z leaves it there.
  const auto p = PlacementMap({1.0, {90, 0, 90}, {}}).to_corner({0, 1, 0});
  CHECK(p == std::array<double, 3>{0, 0, 1});
}

TEST_CASE("the proposed placement puts a half ball with its round side outward", "[core][target]") {
  // A ball cut flat at z = 0 and x = 0, stood on its head and turned away.
  TriangleMesh wedge = shell_of(
      [](double a, double b) {
        const double t = 0.5 * std::numbers::pi * a, y = 60.0 * b;
        return Point{-30.0 * std::sin(t), y, -30.0 * std::cos(t)};
      },
      48, 4);
  const std::string text_before =
      R"({"popcut":1,"surface":)" + kMesh + R"(,"units_per_slice":9,"slices":6,"widths_mm":10})";
  auto read = value(parse_design_spec(text_before));
  DesignSpec spec = read;
  const auto proposed = value(propose_placement(spec, {{"part.stl", binary_stl(wedge)}}));
  CHECK(proposed.unreachable_share < 1e-6);
  CHECK(proposed.reached > 0.8);  // the slices take 55 of 60 mm
  CHECK_FALSE(proposed.reached_before);
  CHECK_THAT(proposed.refused_before, Catch::Contains("in the corner"));
  spec.placement = proposed.placement, spec.fit = FitMode::Nearest;
  const auto made = value(design(spec, {{"part.stl", binary_stl(wedge)}}));
  CHECK(made.report.degrees_of_freedom == 1);
  const auto text = value(with_placement(text_before, proposed));
  const auto again = value(parse_design_spec(text));
  CHECK(again.placement.rotate_deg == proposed.placement.rotate_deg);
  CHECK(again.placement.translate_mm == proposed.placement.translate_mm);
}

TEST_CASE("a proposed placement makes a mesh in metres or micrometres as long as the slices",
          "[core][target]") {
  const std::string text =
      R"({"popcut":1,"surface":)" + kMesh + R"(,"units_per_slice":4,"slices":6,"widths_mm":10})";
  const auto read = value(parse_design_spec(text));
  for (const double unit : {0.001, 1.0 / 25.4, 1.0, 1000.0}) {
    CAPTURE(unit);
    const TriangleMesh house =
        box_mesh({0.0, 0.0, 0.0}, {30.0 * unit, 50.0 * unit, 25.0 * unit}, false);
    const auto proposed = value(propose_placement(read, {{"part.stl", binary_stl(house)}}));
    const auto placed_text = value(with_placement(text, proposed));
    const auto spec = value(parse_design_spec(placed_text));
    if (unit == 1.0) {
      CHECK(placed_text.find("scale_mm") == std::string::npos);
    } else {
      // 0.8 of the slices' 60 mm, in three digits.
      CHECK_THAT(spec.placement.scale_mm * 50.0 * unit, Catch::WithinRel(48.0, 0.005));
    }
    CHECK(design(spec, {{"part.stl", binary_stl(house)}}));
  }
  // A scale that somebody chose stays.
  const std::string chosen = text.substr(0, text.size() - 1) + R"(,"scale_mm":1000})";
  const auto own = value(parse_design_spec(chosen));
  const auto proposed = value(propose_placement(
      own, {{"part.stl", binary_stl(box_mesh({0.0, 0.0, 0.0}, {0.03, 0.05, 0.025}, false))}}));
  CHECK(proposed.placement.scale_mm == 1000.0);
}

TEST_CASE("a proposed placement can be designed and reaches no less than before",
          "[core][target]") {
  struct Shape {
    const char* name;
    TriangleMesh mesh;
  };
  Stand left_out = Stand::Whole;  // with fewer rounds each shape is stood in one way
  for (const Shape& shape :
       {Shape{"ball", icosphere(30.0, 3)}, Shape{"torus", torus(25.0, 10.0, 40)},
        Shape{"box", box_mesh({-20, -30, -10}, {25, 30, 14}, false)},
        // Shorter than the slices in most ways to stand it.
        Shape{"rod", box_mesh({-6, -30, -5}, {6, 30, 5}, false)}}) {
    left_out = left_out == Stand::Whole ? Stand::Quarter : Stand::Whole;
    for (const Stand stand : {Stand::Whole, Stand::Quarter}) {
      if (fewer_rounds() && stand == left_out) continue;
      CAPTURE(shape.name, stand == Stand::Whole);
      const std::string more = R"(, "fit": "nearest", "translate_mm": [12, 20, 9])";
      const SurfaceAssets assets{{"part.stl", binary_stl(shape.mesh)}};
      const auto proposed = value(propose_placement(spec_of(kMesh, more), assets, stand));
      const auto text = value(with_placement(spec_text(kMesh, more), proposed));
      const auto made = value(design(value(parse_design_spec(text)), assets));
      CHECK(made.report.degrees_of_freedom == 1);
      CHECK(proposed.reached > 0.0);
      CHECK(proposed.reached <= 1.0);
      CHECK(proposed.tried > 24);
    }
  }
}

TEST_CASE("a placement that is proposed for facets can be designed", "[core][target]") {
  const std::string text =
      R"({"popcut":1,"style":"facets","surface":)" + kMesh + R"(,"facets":{"strip_mm":6}})";
  const SurfaceAssets assets{
      {"part.stl", binary_stl(box_mesh({-20, -30, -10}, {25, 30, 14}, false))}};
  const auto before = value(parse_design_spec(text));
  const auto proposed = value(propose_placement(before, assets, Stand::Whole));
  const auto placed_text = value(with_placement(text, proposed));
  const auto made = value(design(value(parse_design_spec(placed_text)), assets));
  CHECK(made.report.degrees_of_freedom == 1);
}

TEST_CASE("even sections are those of the mesh slicer", "[core][target]") {
  const TriangleMesh ring = torus(25.0, 10.0, 60);
  const std::array<double, 3> shift{20.0, 31.0, 4.0};
  const auto standing = value(placed(ring, {1.0, {}, shift}));
  const MeshSlicer slicer(standing);
  const EvenPlanes planes{-6.1, 1.7, 48};  // some before and some behind the ring
  const auto sections = even_sections(ring, shift, planes);
  REQUIRE(sections.size() == 48);
  const auto length = [](const Section& section) {
    double sum = 0.0;
    for (const SectionSegment& piece : section.segments)
      sum += std::hypot(piece.b.x - piece.a.x, piece.b.z - piece.a.z);
    return sum;
  };
  double all = 0.0;
  for (int k = 0; k < planes.count; ++k) {
    CAPTURE(k);
    const Section whole = slicer.cut(planes.first_mm + k * planes.step_mm);
    const Section& mine = sections[static_cast<std::size_t>(k)];
    CHECK(mine.segments.size() == whole.segments.size());
    CHECK(length(mine) == Approx(length(whole)).margin(1e-3));
    all += length(mine);
  }
  CHECK(all > 1000.0);
}

TEST_CASE("the reached share of a plate is that of the strips beside it", "[core][target]") {
  // A plate 100 mm long and 60 mm high, 20 mm from the wall; its foot stands on the ground.
  const TriangleMesh plate = shell_of(
      [](double a, double b) {
        return Point{20.0, 100.0 * b, 60.0 * a};
      },
      3, 5);
  const std::vector<Vec3> points = area_points(plate, 20'000);
  REQUIRE(points.size() == 20'000);
  const std::vector<SectionPoint> whole{{20.0, 60.0}, {20.0, 0.0}}, half{{21.0, 30.0}, {21.0, 0.0}};
  const auto share = [&](const std::vector<ProfileStrip>& strips, double near_mm) {
    return reached_share(points, strips, near_mm);
  };
  CHECK(share({{0.0, 100.0, whole}}, 1.0) == 1.0);
  CHECK(share({}, 1.0) == 0.0);
  CHECK(share({{0.0, 25.0, whole}, {25.0, 50.0, {}}}, 1.0) == Approx(0.26).margin(1e-3));
  CHECK(share({{0.0, 25.0, whole}, {50.0, 75.0, half}}, 0.5) == Approx(0.255).margin(1e-3));
  // One millimetre beside the plate: sqrt(near^2 - 1) is left above the half's top and beyond.
  const double left = std::sqrt(8.0);
  CHECK(
      share({{0.0, 50.0, half}}, 3.0) ==
      Approx((50.0 * (30.0 + left) + 30.0 * left + 0.25 * std::numbers::pi * left * left) / 6000.0)
          .margin(1e-3));
}

TEST_CASE("the report of a mesh names the parts out of reach", "[core][target]") {
  const DesignSpec spec = spec_of(kMesh, R"(, "fit": "nearest", "translate_mm": [28, 20, 28])");
  const auto made = value(design(spec, {{"part.stl", binary_stl(icosphere(30.0, 4))}}));
  CHECK(made.report.degrees_of_freedom == 1);
  CHECK(unreachable_share(made.report.fit) > 0.5);
  CHECK(made.report.fit_nearest);
  const std::string json = report_json(made.report);
  for (const char* field : {"\"unreachable_share\"", "\"rms_mm\"", "\"max_mm\"", "\"nearest\""})
    CHECK(json.find(field) != std::string::npos);
  bool said = false;
  for (const std::string& note : made.report.notes)
    said = said || note.find("out of reach") != std::string::npos;
  CHECK(said);
}

TEST_CASE("a mesh that cannot be used is refused with its own reason", "[core][target]") {
  const auto refusal = [](const TriangleMesh& mesh, const TargetPlacement& placement) {
    const auto made = mesh_surface(mesh, placement);
    if (!made) return made.error();
    const auto slice = made->cut(5.0);
    if (slice) FAIL("it was cut");
    return slice.error();
  };
  const Error hole = refusal(box_mesh({-5, 0, -5}, {20, 10, 20}, true), {});
  CHECK(hole.kind == ErrorKind::Infeasible);
  CHECK(hole.detail.find("hole") != std::string::npos);
  CHECK(hole.detail.find("x = 20") != std::string::npos);
  const Error outside = refusal(box_mesh({-9, 0, 0}, {-5, 10, 10}, false), {});
  CHECK(outside.kind == ErrorKind::Infeasible);
  CHECK(outside.place == "/translate_mm");
  CHECK(outside.detail.find("x = -9 to -5") != std::string::npos);
  const Error beside = refusal(box_mesh({-5, 20, -5}, {20, 30, 20}, false), {});
  CHECK(beside.detail.find("spans y = 20 to 30 mm only") != std::string::npos);
  const Error huge = refusal(icosphere(1.0, 0), {1e9, {}, {}});
  CHECK(huge.kind == ErrorKind::OutOfRange);
  CHECK(huge.place == "/scale_mm");
  const Error absent = surface(MeshSpec{"other.stl"}, {{"part.stl", ""}}).error();
  CHECK(absent.kind == ErrorKind::Malformed);
  CHECK(absent.place == "/surface/file");
}

TEST_CASE("formulas know how to round and name what they know", "[core][target]") {
  const auto value = [](const char* text, double x) {
    const auto formula = testing::value(Expression::parse(text, {"x"}));
    return formula(x);
  };
  CHECK(value("floor(x)", -1.5) == -2.0);
  CHECK(value("ceil(x)", -1.5) == -1.0);
  CHECK(value("round(x)", 2.5) == 3.0);
  CHECK(value("mod(x, 3)", 7.5) == 1.5);
  CHECK(value("mod(x, 3)", -1.0) == 2.0);
  CHECK(std::isnan(value("mod(x, 0)", 1.0)));
  for (const char* text : {"frac(x)", "x + foo"}) {
    const auto unknown = Expression::parse(text, {"x", "y"});
    REQUIRE_FALSE(unknown);
    CHECK_THAT(unknown.error().detail, Catch::Contains("it knows x, y, pi, e, and the functions"));
    CHECK_THAT(unknown.error().detail, Catch::Contains("acos") && Catch::Contains("floor") &&
                                           Catch::Contains("mod") && Catch::Contains("tanh"));
  }
  for (const auto& [text, near] : {std::pair{"36 - Y^2", "y"},
                                   {"sqr(36 - y^2)", "sqrt"},
                                   {"2 * PI * x", "pi"},
                                   {"arctan(x)", "atan"}})
    CHECK_THAT(Expression::parse(text, {"x", "y"}).error().detail,
               Catch::Contains(fmt::format("did you mean {}?", near)));
  CHECK_THAT(Expression::parse("elephant + 1", {"x"}).error().detail,
             !Catch::Contains("did you mean"));
}

TEST_CASE("a target that ends inside a slice is cut where it still is", "[core][target][design]") {
  // A ball of 40 mm from y = 0 to 80: the middles of the first and the last slice touch its poles.
  const TriangleMesh ball = sphere_mesh(40.0, 60, 60);
  const auto designed = [&](const std::string& surface, const std::string& more) {
    const auto spec = value(parse_design_spec(
        R"({"popcut":1,"units_per_slice":3,"slices":9,"widths_mm":10,"surface":)" + surface + more +
        "}"));
    auto made = value(design(spec, {{"b.stl", binary_stl(ball)}}));
    CHECK(made.report.degrees_of_freedom == 1);
    CHECK(made.report.slices.size() == 9);
    return made.report.notes;
  };
  const std::string says = "slice 8: the target ends there; its curve is the one at s = 77.";
  const auto said = [&](const std::vector<std::string>& notes) {
    return std::any_of(notes.begin(), notes.end(),
                       [&](const std::string& note) { return note.rfind(says, 0) == 0; });
  };
  CHECK(said(designed(R"j({"type":"revolution","radius":"sqrt(40^2-(y-40)^2)"})j", "")));
  CHECK(said(designed(R"j({"type":"profile","z":"sqrt(40^2-(y-40)^2)-x"})j", "")));
  CHECK(said(designed(R"j({"type":"implicit","f":"x^2+(y-40)^2+z^2-40^2"})j", "")));
  CHECK(said(designed(R"({"type":"mesh","file":"b.stl"})",
                      R"(,"fit":"nearest","translate_mm":[0,40,0])")));
  // Two millimetres beyond both ends.
  CHECK(said(designed(R"({"type":"mesh","file":"b.stl"})",
                      R"(,"fit":"nearest","scale_mm":0.95,"translate_mm":[0,41.5,0])")));
}

TEST_CASE("a target beyond every slice is infeasible and says where it is", "[core][target]") {
  const TriangleMesh ball = sphere_mesh(40.0, 20, 20);
  const auto spec = value(parse_design_spec(
      R"({"popcut":1,"units_per_slice":3,"slices":5,"widths_mm":10,"fit":"nearest",
          "surface":{"type":"mesh","file":"b.stl"},"translate_mm":[0,-90,0]})"));
  const auto made = design(spec, {{"b.stl", binary_stl(ball)}});
  REQUIRE_FALSE(made);
  CHECK(made.error().kind == ErrorKind::Infeasible);
  CHECK(made.error().reason == ErrorReason::Misplaced);  // the command line names --place
  CHECK_THAT(made.error().detail, Catch::Contains("spans y = -130 to -50 mm only"));
}

TEST_CASE("conformal planes without room become levels that end", "[core][design]") {
  const auto spec = value(parse_design_spec(
      R"j({"popcut":1,"surface":{"type":"revolution","radius":"sqrt(70^2-(y-50)^2)"},
          "units_per_slice":40,"slices":10,"widths_mm":10,"min_panel_mm":2,
          "lattice":"conformal"})j"));
  const auto made = value(design(spec));
  CHECK(made.report.lattice == "levels");
  auto many = spec;
  for (RegionSpec& region : many.regions) region.units_per_slice = 2000;
  const auto refused = design(many);
  REQUIRE_FALSE(refused);
  CHECK_THAT(refused.error().detail, Catch::Contains("at most 31 units fit"));
  CHECK_THAT(made.report.lattice_note, Catch::Contains("levels taken, since conformal"));
  CHECK(made.report.degrees_of_freedom == 1);
}

TEST_CASE("a solid that cannot be used is refused with its own reason", "[core][target]") {
  const auto refusal = [](const std::string& f) {
    const auto made = surface(ImplicitSpec{f});
    if (!made) return made.error();
    const auto slice = made->cut(0.0);
    if (slice) FAIL("it was cut");
    return slice.error();
  };
  CHECK(refusal("x^2 + ").place == "/surface/f");
  CHECK(refusal("x^2 + ").kind == ErrorKind::Malformed);
  CHECK(refusal("w - 1").kind == ErrorKind::Malformed);
  CHECK(refusal("1").detail.find("no part of the solid is in the corner") != std::string::npos);
  CHECK(refusal("0/0").kind == ErrorKind::Infeasible);
  CHECK(refusal("z - 1").detail.find("does not end") != std::string::npos);
  CHECK(refusal("abs(z - 0.3*x) - 4").detail.find("does not end") != std::string::npos);
  CHECK(refusal("(x-3)^2 + (z-3)^2 - 1").detail.find("does not reach the wall") !=
        std::string::npos);
}

TEST_CASE("placement and fit of a spec are read or refused with their place", "[core][spec]") {
  const DesignSpec spec = spec_of(
      R"({"type": "implicit", "f": "x^2+z^2-1"})",
      R"(, "rotate_deg": [0, 90, -180.5], "translate_mm": [1, 2, 3], "scale_mm": 7, "fit": "nearest")");
  CHECK(spec.placement.rotate_deg == std::array<double, 3>{0, 90, -180.5});
  CHECK(spec.placement.translate_mm == std::array<double, 3>{1, 2, 3});
  CHECK(spec.placement.scale_mm == 7.0);
  CHECK(spec.fit == FitMode::Nearest);
  CHECK(asset_of(spec_of(R"({"type": "grid", "file": "a/h.csv"})").surface) == "a/h.csv");
  struct Row {
    const char* surface;
    const char* more;
    const char* place;
    ErrorKind kind;
  };
  for (const Row& row :
       {Row{R"({"type": "mesh"})", "", "/surface/file", ErrorKind::Malformed},
        Row{R"({"type": "mesh", "file": ""})", "", "/surface/file", ErrorKind::OutOfRange},
        Row{R"({"type": "mesh", "file": 3})", "", "/surface/file", ErrorKind::Malformed},
        Row{R"({"type": "grid", "file": "a", "f": "x"})", "", "/surface/f", ErrorKind::Malformed},
        Row{R"({"type": "ball"})", "", "/surface/type", ErrorKind::OutOfRange},
        Row{R"({"f": "x"})", "", "/surface/type", ErrorKind::Malformed},
        Row{R"({"type": "implicit"})", "", "/surface/f", ErrorKind::Malformed},
        Row{R"({"type": "implicit", "f": "x"})", R"(, "fit": "best")", "/fit",
            ErrorKind::OutOfRange},
        Row{R"({"type": "implicit", "f": "x"})", R"(, "rotate_deg": 90)", "/rotate_deg",
            ErrorKind::Malformed},
        Row{R"({"type": "implicit", "f": "x"})", R"(, "rotate_deg": [1, 2])", "/rotate_deg",
            ErrorKind::Malformed},
        Row{R"({"type": "implicit", "f": "x"})", R"(, "rotate_deg": [1, 2, 1e9])", "/rotate_deg/2",
            ErrorKind::OutOfRange},
        Row{R"({"type": "implicit", "f": "x"})", R"(, "translate_mm": [1, null, 0])",
            "/translate_mm/1", ErrorKind::Malformed}}) {
    CAPTURE(row.surface, row.more);
    const auto refused = parse_design_spec(spec_text(row.surface, row.more));
    REQUIRE_FALSE(refused);
    CHECK(refused.error().place == row.place);
    CHECK(refused.error().kind == row.kind);
  }
  const auto contradictory = parse_design_spec(
      R"({"popcut": 1, "regions": [{"radius": "5", "units_per_slice": 2, "slices": 3,
          "width_mm": 4}], "rotate_deg": [0, 0, 90]})");
  REQUIRE_FALSE(contradictory);
  CHECK(contradictory.error().place == "/rotate_deg");
}

TEST_CASE("a chain with several minima takes the best one and reports the spread",
          "[core][chain]") {
  // Wiggles whose minima docs/geometry.md, section 3, lists: with two waves and nine units a second
  // one at 2.81 times; with four the start at equal arcs ends 1 / 0.845 times above the best.
  const auto solved = [](int waves, int units) {
    const auto curve =
        surface(ProfileSpec{fmt::format("1 - x + 0.95*sin({0}*pi*x)/({0}*pi)", 2 * waves)});
    std::vector<double> x(static_cast<std::size_t>(units) + 1), z(x.size());
    auto figures = value(ChainSolver{}.solve(cut(curve, 0.0).curve, units, x, z));
    CHECK_THAT(chain_loss(x, z), Catch::WithinRel(figures.loss, 1e-12));
    return figures;
  };
  const ChainFigures two = solved(2, 9), four = solved(4, 9);
  CHECK(two.minima == 2);
  CHECK_THAT(two.spread, Catch::WithinAbs(1.81, 0.005));
  CHECK(four.minima > 2);
  CHECK_THAT(four.loss, Catch::WithinRel(0.845 * 0.0191904798, 1e-3));
  std::vector<double> x(10), z(10);
  const auto circle = ChainSolver{}.solve(SliceCurve(1.0, 1.0), 9, x, z);
  CHECK(circle->minima == 1);
  CHECK(circle->spread == 0.0);
  CHECK(circle->iterations <= 8);
}

TEST_CASE("a drawn curve that cannot be used is refused at its own point", "[core][spec][drawn]") {
  const auto refused = [](const std::string& surface_json) {
    const auto spec = parse_design_spec(spec_text(surface_json));
    REQUIRE_FALSE(spec);
    return message(spec.error());
  };
  const auto radius = [](const std::string& points) {
    return fmt::format(R"({{"type": "revolution", "radius": {{"points": {}}}}})", points);
  };
  using Catch::Matchers::StartsWith;
  CHECK_THAT(refused(radius("[[0, 9]]")),
             StartsWith("/surface/radius/points: is a list of 1; must be a list of 2 to 1000"));
  CHECK_THAT(refused(radius("[[0, 9], [5, 8], [5, 7]]")),
             StartsWith("/surface/radius/points/2/0: is 5; must be above 5"));
  CHECK_THAT(refused(radius("[[0, 9], [1e-300, 8], [5, 7]]")),
             StartsWith("/surface/radius/points/1/0: is 1e-300; must be above 0"));
  CHECK_THAT(refused(radius("[[0, 9], [5, -0.5]]")),
             StartsWith("/surface/radius/points/1/1: is -0.5; must be a radius of 0 or more"));
  CHECK_THAT(refused(radius("[[0, 9], [5]]")), StartsWith("/surface/radius/points/1: "));
  CHECK_THAT(refused(radius("[[0, 9], [5, \"8\"]]")), StartsWith("/surface/radius/points/1/1: "));
  CHECK_THAT(refused(radius("[[0, 9], [5, 1e300]]")), StartsWith("/surface/radius/points/1/1: "));
  CHECK_THAT(refused(radius("[[0, 9], [5, 1e999]]")), StartsWith("line 1, column "));
  CHECK_THAT(refused(R"({"type": "revolution", "radius": 9})"), StartsWith("/surface/radius: "));
  CHECK_THAT(refused(R"({"type": "revolution", "radius": {"points": [[0, 9], [5, 8]], "x": 1}})"),
             StartsWith("/surface/radius/x: "));
  std::string many;
  for (int k = 0; k <= 1000; ++k) many += fmt::format("{}[{}, 9]", k == 0 ? "" : ", ", k);
  CHECK_THAT(refused(radius("[" + many + "]")), StartsWith("/surface/radius/points: "));

  const auto profile = [](const std::string& points) {
    return fmt::format(R"({{"type": "profile", "z": {{"points": {}}}}})", points);
  };
  CHECK_THAT(refused(profile("[[1, 9], [5, 0]]")), StartsWith("/surface/z/points/0/0: is 1;"));
  CHECK_THAT(refused(profile("[[0, 0], [5, 0]]")), StartsWith("/surface/z/points/0/1: is 0;"));
  CHECK_THAT(refused(profile("[[0, 9], [5, 10], [6, 0]]")),
             StartsWith("/surface/z/points/1/1: is 10; must be at most 9"));
  CHECK_THAT(refused(profile("[[0, 9], [5, 4], [4, 0]]")),
             StartsWith("/surface/z/points/2/0: is 4; must be at least 5"));
  CHECK_THAT(refused(profile("[[0, 9], [5, 4], [5, 4], [6, 0]]")),
             StartsWith("/surface/z/points/2: is the point before it"));
  CHECK_THAT(refused(profile("[[0, 9], [5, 1]]")), StartsWith("/surface/z/points/1/1: is 1;"));
  CHECK_THAT(refused(profile("[[0, 9], [0, 0]]")), StartsWith("/surface/z/points/1/0: is 0;"));

  const auto loft = [](const std::string& stations) {
    return fmt::format(R"({{"type": "loft", "stations": [{}]}})", stations);
  };
  const std::string first = R"({"y": 0, "curve": [[0, 9], [5, 0]]})";
  CHECK_THAT(refused(loft(first)), StartsWith("/surface/stations: is a list of 1;"));
  CHECK_THAT(refused(loft(first + R"(, {"y": 0, "curve": [[0, 9], [5, 0]]})")),
             StartsWith("/surface/stations/1/y: is 0; must be above 0"));
  CHECK_THAT(refused(loft(first + R"(, {"y": 5, "curve": [[0, 9], [2, 3], [5, 0]]})")),
             StartsWith("/surface/stations/1/curve: has 3 points; must have 2"));
  CHECK_THAT(refused(loft(first + R"(, {"y": 5, "curve": [[0, 9], [5, 1]]})")),
             StartsWith("/surface/stations/1/curve/1/1: is 1;"));
  CHECK_THAT(refused(loft(first + R"(, {"curve": [[0, 9], [5, 0]]})")),
             StartsWith("/surface/stations/1/y: is missing"));
}

TEST_CASE("a drawn surface ends at its first and last point", "[core][target][drawn]") {
  const auto drawn = surface(RevolutionSpec{CurvePoints{{0, 40}, {20, 30}, {50, 45}}});
  CHECK(cut(drawn, 20.0).curve.h() == 30.0);
  CHECK(cut(drawn, 50.0).curve.h() == 45.0);
  CHECK(drawn->cut(-0.1).error().reason == ErrorReason::Misplaced);
  const Error beyond = drawn->cut(51.0).error();
  CHECK(beyond.kind == ErrorKind::OutOfRange);
  CHECK(beyond.place == "/surface/radius at s = 51 mm");
  CHECK_THAT(beyond.detail, Catch::Matchers::Contains("its points reach from y = 0 to 50"));
  // A slice in which it ends takes what is there, as with a formula.
  const auto spec = spec_of(R"({"type": "revolution", "radius": {"points": [[0, 30], [38, 35]]}})");
  const auto made = value(design(spec));
  CHECK(std::any_of(made.report.notes.begin(), made.report.notes.end(), [](const auto& note) {
    return note.find("the target ends there") != std::string::npos;
  }));
  // One curve for all of the spine has no ends.
  const auto profile = surface(ProfileSpec{CurvePoints{{0, 30}, {10, 25}, {28, 0}}});
  CHECK(cut(profile, -500.0).curve.h() == 30.0);
  CHECK(cut(profile, 500.0).curve.d() == 28.0);
}

TEST_CASE("the nearest place of a curve that turns both ways is found from far away",
          "[core][target][drawn]") {
  // A step: an upright wall at x = 33, and before it a ledge.
  const auto step =
      surface(ProfileSpec{CurvePoints{{0, 63}, {16, 42}, {33, 37}, {33, 19}, {33, 0.5}, {49, 0}}});
  const SliceCurve curve = cut(step, 0.0).curve;
  for (double x = 0.0; x <= 60.0; x += 3.7)
    for (double z = 0.0; z <= 70.0; z += 3.9) {
      double least = std::numeric_limits<double>::infinity();
      for (int k = 0; k <= 4000; ++k) {
        const CurveJet p = curve.at(-1.0 + k / 2000.0);
        least = std::min(least, std::hypot(p.x - x, p.z - z));
      }
      CAPTURE(x, z);
      CHECK(curve.nearest_distance({x, z}) ==
            Approx(least).margin(0.05));  // it may stop at a corner
    }
}

}  // namespace targets_test
