// SPDX-License-Identifier: MIT
// Designs for cards that are open to another angle than 90 degrees: sound, and right at that angle.
#include <cmath>
#include <numbers>
#include <optional>
#include <random>
#include <sstream>
#include <string>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "core/design/patches.hpp"
#include "core/design/placement.hpp"
#include "core/design/shape_fit.hpp"
#include "core/formats/fold/fold_writer.hpp"
#include "core/formats/write/report_json.hpp"
#include "core/verify/verify.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/value.hpp"

namespace design_angle_property_test {

using namespace popcut;

namespace {

Design designed(const std::string& text, const std::string& bytes = {}) {
  CAPTURE(text);
  const auto spec = testing::value(parse_design_spec(text));
  auto made = testing::value(design_assembly(spec, {{asset_of(spec.surface), bytes}}));
  REQUIRE(made.parts.size() == 1);
  return std::move(made.parts.front());
}

std::string fold_of(const Design& made) {
  std::ostringstream fold;
  REQUIRE(write_fold(made.pattern, {}, fold));
  return std::move(fold).str();
}

/// Sound with one freedom, and as far from the target as the design says. With a nearest curve the
/// design measures from that, not from the target: then there is no `within_mm`.
void check_verified(const std::string& text, std::optional<double> within_mm,
                    const std::string& bytes = {}) {
  CAPTURE(text);
  const Design made = designed(text, bytes);
  VerifyOptions options;
  options.degrees_of_freedom = 1;
  options.target_spec = text;
  for (const std::string& name : target_files_of(text)) options.target_files.emplace(name, bytes);
  const auto verified = testing::value(verify_fold(fold_of(made), options));
  INFO(verify_text(verified));
  CHECK(verified.ok());
  REQUIRE(verified.target_inner);
  CHECK(verified.target_inner->vertices > 0);
  if (!within_mm) return;
  CHECK(verified.target_inner->rms_mm == Approx(made.report.inner_error.rms_mm).margin(*within_mm));
  CHECK(verified.target_inner->max_mm == Approx(made.report.inner_error.max_mm).margin(*within_mm));
}

std::string spec_of(const std::string& surface, double angle_deg, const std::string& more = "",
                    int units = 5) {
  return fmt::format(
      R"({{"popcut":1,"surface":{},"design_angle_deg":{:.17g},"units_per_slice":{},"slices":6,
          "widths_mm":7{}}})",
      surface, angle_deg, units, more);
}

constexpr const char* kBarrel = R"j({"type":"revolution","radius":"50+4*sin(y/9)"})j";

}  // namespace

TEST_CASE("designs for any opening angle are sound and verify finds their error at that angle",
          "[property][design][verify][angle]") {
  constexpr unsigned kSeed = 70;
  std::mt19937 random(kSeed);
  const auto angle = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random()) / 4294967295.0;
  };
  for (int round = 0; round < 2; ++round) {
    CAPTURE(kSeed, round);
    check_verified(spec_of(kBarrel, angle(30, 90)), 1e-7);
    check_verified(spec_of(kBarrel, angle(30, 90), R"(,"lattice":"slices")"), 1e-7);
    check_verified(spec_of(R"j({"type":"implicit","f":"x^2+z^2-2500-9*y"})j", angle(30, 88)), 1e-6);
    check_verified(spec_of(R"j({"type":"profile","z":"40-x*(0.6+0.004*y)"})j", angle(60, 120)),
                   1e-6);
    // Over a right angle a circle does not fall.
    check_verified(spec_of(kBarrel, angle(92, 150), R"(,"fit":"nearest")"), std::nullopt);
  }
  std::string csv = ",-40,0,10,20,30,40\n";
  for (int y = 0; y <= 60; y += 20) csv += fmt::format("{},48,40,37,{},18,0\n", y, 30 + y / 10);
  check_verified(spec_of(R"({"type":"grid","file":"h.csv"})", 75), 1e-3, csv);
  check_verified(spec_of(R"({"type":"mesh","file":"b.stl"})", 65, R"(,"translate_mm":[0,10,0])"),
                 2e-3, testing::binary_stl(testing::sphere_mesh(60.0, 60, 60)));
  check_verified(R"j({"popcut":1,"surface":{"type":"composite","radii":[60,25,40]},
      "design_angle_deg":50,"regions":[{"units_per_slice":1,"slices":4,"width_mm":12},
      {"units_per_slice":2,"slices":8,"width_mm":4},{"units_per_slice":3,"slices":6,"width_mm":8}]})j",
                 1e-7);
  check_verified(R"j({"popcut":1,"design_angle_deg":55,"patches":[
      {"surface":{"type":"revolution","radius":"50"},"units_per_slice":5,"slices":4,"widths_mm":8},
      {"surface":{"type":"revolution","radius":"50+y/20"},"units_per_slice":4,"slices":4,
       "widths_mm":8}]})j",
                 1e-7);
}

TEST_CASE("the fit of a design is that of its panels in space at the design angle",
          "[property][design][fit][angle]") {
  for (const double angle_deg : {34.0, 57.0, 81.0}) {
    CAPTURE(angle_deg);
    const double a = angle_deg / 180.0 * std::numbers::pi;
    const Design made = designed(spec_of(R"({"type":"revolution","radius":"50"})", angle_deg));
    // Each panel that is not wall or ground, sampled along its way: all are as wide as their strip.
    double sum = 0.0, area = 0.0, farthest = 0.0;
    const Strips& strips = made.strips;
    for (std::size_t k = 0; k < strips.size(); ++k) {
      if (strips.kind[k] == StripKind::Margin) continue;
      const double width = strips.v_begin[k + 1] - strips.v_begin[k];
      for (std::size_t p = strips.first_panel[k]; p < strips.first_panel[k + 1]; ++p) {
        if (strips.plane[p] == kWallPlane || strips.plane[p] == kGroundPlane) continue;
        const std::size_t q = p + k;
        constexpr int kSamples = 400;
        const double length = std::abs(strips.x[q + 1] - strips.x[q]) +  // one of them is 0
                              std::abs(strips.z[q + 1] - strips.z[q]);
        for (int i = 0; i < kSamples; ++i) {
          const double share = (i + 0.5) / kSamples;
          const double x = strips.x[q] + share * (strips.x[q + 1] - strips.x[q]);
          const double z = strips.z[q] + share * (strips.z[q + 1] - strips.z[q]);
          const double off = std::abs(std::hypot(x + z * std::cos(a), z * std::sin(a)) - 50.0);
          const double here = width * length / kSamples;
          sum += here * off, area += here, farthest = std::max(farthest, off);
        }
      }
    }
    const FitFigures fit = *surface_fit(made);
    CHECK(fit.to_target.mean_mm == Approx(sum / area).epsilon(0.01));
    CHECK(fit.to_target.max_mm == Approx(farthest).epsilon(0.02));
    CHECK(fit.structure_mm2 == Approx(area).epsilon(1e-6));
    // A sector of a cylinder between the middles of the outer strips' far edges.
    const double length = made.pattern.width_mm - 30.0;
    CHECK(fit.target_mm2 == Approx(50.0 * a * length).epsilon(0.002));
    CHECK(fit.out_of_reach.share() == 0.0);
  }
}

TEST_CASE("more units come nearer to the target at its design angle",
          "[property][design][fit][angle]") {
  for (const double angle_deg : {40.0, 65.0}) {
    double before = 1e9;
    for (const int units : {3, 6, 12, 24}) {
      CAPTURE(angle_deg, units);
      const Design made = designed(spec_of(kBarrel, angle_deg, "", units));
      const double off = surface_fit(made)->to_target.mean_mm;
      CHECK(off < 0.65 * before);
      before = off;
    }
  }
}

TEST_CASE("a design angle of 90 degrees changes nothing", "[property][design][angle]") {
  for (const char* surface : {kBarrel, R"j({"type":"profile","z":"40-x"})j"}) {
    const Design with = designed(spec_of(surface, 90.0));
    const Design without = designed(fmt::format(
        R"({{"popcut":1,"surface":{},"units_per_slice":5,"slices":6,"widths_mm":7}})", surface));
    CHECK(fold_of(with) == fold_of(without));
    CHECK(report_json(with.report) == report_json(without.report));
  }
}

TEST_CASE("a design angle that cannot be is refused with its place", "[property][design][angle]") {
  const auto refusal = [](const std::string& text) {
    const auto spec = parse_design_spec(text);
    if (!spec) return message(spec.error());
    const auto made = design_assembly(*spec);
    return made ? std::string("made") : message(made.error());
  };
  for (const double angle_deg : {29.9, 151.0, 0.0, -90.0}) {
    CAPTURE(angle_deg);
    CHECK_THAT(refusal(spec_of(kBarrel, angle_deg)), Catch::StartsWith("/design_angle_deg"));
  }
  CHECK_THAT(refusal(spec_of(kBarrel, 100)),
             Catch::StartsWith("/design_angle_deg: is 100; over 90"));
  CHECK_THAT(refusal(spec_of(kBarrel, 70, R"(,"curvature":{"H":0.01})")),
             Catch::StartsWith("/curvature: holds at a right angle only"));
  CHECK_THAT(refusal(R"j({"popcut":1,"patches":[{"surface":{"type":"revolution","radius":"50"},
          "design_angle_deg":70,"units_per_slice":5,"slices":4,"widths_mm":8},
          {"surface":{"type":"revolution","radius":"50"},"units_per_slice":5,"slices":4,
          "widths_mm":8}]})j"),
             Catch::StartsWith("/patches/0/design_angle_deg: belongs to the whole"));
  const auto spec =
      testing::value(parse_design_spec(spec_of(R"({"type":"mesh","file":"b.stl"})", 65)));
  const auto proposed =
      propose_placement(spec, {{"b.stl", testing::binary_stl(testing::sphere_mesh(60.0, 20, 20))}});
  REQUIRE_FALSE(proposed);
  CHECK_THAT(message(proposed.error()), Catch::StartsWith("/design_angle_deg: is 65"));
}

}  // namespace design_angle_property_test
