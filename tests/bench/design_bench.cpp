// SPDX-License-Identifier: MIT
#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "core/design/chain/chain.hpp"
#include "core/design/design.hpp"
#include "core/design/lattice/lattice.hpp"
#include "core/design/shape_fit.hpp"
#include "core/formats/fold/fold_writer.hpp"
#include "tests/support/timing.hpp"
#include "tests/support/value.hpp"

namespace design_bench {

using namespace popcut;
using namespace popcut::testing;

namespace {

DesignSpec spec_of(const char* radius, int units, int slices, double width_mm, const char* lattice,
                   const char* max_step = "null") {
  return value(parse_design_spec(fmt::format(
      R"({{"popcut":1,"surface":{{"type":"revolution","radius":"{}"}},"scale_mm":100,"units_per_slice":{},
          "slices":{},"widths_mm":{},"lattice":"{}","min_panel_mm":{},"max_step_over_mean":{}}})",
      radius, units, slices, width_mm, lattice, 10.0 / units, max_step)));
}

constexpr const char* kSphere = "sqrt(1.05-y^2)";
constexpr const char* kSaddle = "sqrt(1+y^2)";
constexpr const char* kWave = "1+0.15*sin(3*y)";

}  // namespace

TEST_CASE("seconds a slice: Newton beside SLSQP", "[bench]") {
  fmt::print("quarter circle, one slice      Newton    steps   us a unit        SLSQP    times\n");
  ChainSolver solver;
  const SliceCurve circle(50.0, 50.0);
  for (const int units : {9, 50, 200, 500}) {
    std::vector<double> x(static_cast<std::size_t>(units) + 1), z(x.size());
    int steps = 0;
    const double newton =
        median_of(51, [&] { steps = solver.solve(circle, units, x, z)->iterations; });
    // SLSQP's cost grows with the cube of the units: one run, and at most two minutes.
    bool done = true;
    const double slsqp = median_of(units <= 50 ? 5 : 1, [&] {
      SlsqpBudget budget{120.0};
      done = solve_chain_slsqp(circle, units, x, z, budget).has_value();
    });
    fmt::print("N = {:4}               {:10.1f} us {:6} {:10.3f}  {:>1}{:10.4f} s {:8.0f}\n", units,
               1e6 * newton, steps, 1e6 * newton / units, done ? " " : ">", slsqp, slsqp / newton);
  }
}

TEST_CASE("a lattice of 100 units x 1000 slices, and of twice the slices", "[bench]") {
  double first = 0.0;
  for (const int slices : {1000, 2000}) {
    const DesignSpec spec = spec_of(kSphere, 100, slices, 80.0 / slices, "slices");
    Design made;
    const double built = median_of(3, [&] { made = value(design(spec)); });
    FoldOptions options;
    options.psi_rad = std::vector{std::numbers::pi / 2};
    const std::string path = std::string(P_tmpdir) + "/popcut_bench.fold";
    const double written = median_of(3, [&] {
      std::ofstream out(path, std::ios::binary);
      REQUIRE(write_fold(made.pattern, options, out));
    });
    std::ifstream size(path, std::ios::binary | std::ios::ate);
    fmt::print(
        "100 units x {} slices: {} faces, {} folds, {} cuts; built in {:.2f} s, FOLD ({} MB) in "
        "{:.2f} s, peak {} MB",
        slices, made.report.faces, made.report.folds, made.report.cuts, built,
        static_cast<long>(size.tellg()) >> 20, written, peak_mb());
    if (first > 0.0) fmt::print("; {:.2f} times the half", (built + written) / first);
    fmt::print("\n");
    first = built + written;
    std::remove(path.c_str());
  }
}

TEST_CASE("lattices and their four figures", "[bench]") {
  fmt::print("{:8} {:>8} {:10} {:>10} {:>10} {:>10} {:>14} {:>8} {:>8} {:>7}\n", "target", "N x Ns",
             "lattice", "rms/r", "inner/r", "ends/r", "step/mean", "gap/r", "merged", "s");
  struct Row {
    const char* name;
    const char* radius;
    int units, slices;
    double width;
  };
  for (const Row& row :
       {Row{"sphere", kSphere, 5, 8, 0.1}, Row{"sphere", kSphere, 8, 8, 0.1},
        Row{"saddle", kSaddle, 8, 8, 0.1}, Row{"wave", kWave, 10, 20, 0.035},
        Row{"sphere", kSphere, 20, 60, 0.013}, Row{"saddle", kSaddle, 20, 60, 0.013},
        Row{"sphere", kSphere, 30, 120, 0.007}, Row{"saddle", kSaddle, 30, 120, 0.007},
        Row{"sphere", kSphere, 50, 200, 0.004}})
    for (const auto& [lattice, most] : {std::pair{"branching", "null"}, std::pair{"slices", "null"},
                                        std::pair{"conformal", "null"}, std::pair{"conformal", "3"},
                                        std::pair{"levels", "null"}, std::pair{"direct", "null"}}) {
      const DesignSpec spec =
          spec_of(row.radius, row.units, row.slices, 100 * row.width, lattice, most);
      DesignReport r;
      const double seconds = seconds_of([&] {
        auto result = value(design(spec));
        r = std::move(result.report);
      });
      fmt::print(
          "{:8} {:>8} {:10} {:10.1e} {:10.1e} {:10.1e} {:6.3f}..{:6.2f} {:8.4f} {:8} {:7.2f}{}\n",
          row.name, fmt::format("{}x{}", row.units, row.slices),
          fmt::format("{}{}", lattice, most[0] == '3' ? "<3" : ""), r.inner_error.rms_mm / 100,
          r.inner_error.max_mm / 100, r.end_error.max_mm / 100, r.step_over_mean_min,
          r.step_over_mean_max, r.gap_mm / 100, r.merged.size(), seconds,
          r.lattice == lattice ? "" : "  (" + r.lattice + " taken)");
    }
}

TEST_CASE("the fit beside the design that it measures", "[bench]") {
  fmt::print("{:8} {:>9} {:10} {:>10} {:>9} {:>7} {:>10} {:>8} {:>11}\n", "target", "N x Ns",
             "lattice", "design, s", "fit, s", "share", "triangles", "samples", "mean, p95");
  for (const auto& [units, slices, lattice] :
       {std::tuple{5, 10, "auto"}, std::tuple{20, 40, "auto"}, std::tuple{50, 200, "auto"},
        std::tuple{50, 200, "slices"}, std::tuple{50, 200, "conformal"},
        std::tuple{100, 1000, "slices"}}) {
    const DesignSpec spec = spec_of(kSphere, units, slices, 80.0 / slices, lattice);
    Design made;
    const double whole = seconds_of([&] { made = value(design(spec)); });
    std::optional<FitFigures> fit;
    const double measured = median_of(3, [&] { fit = surface_fit(made); });
    REQUIRE(fit);
    const std::size_t triangles = 2 * made.strips.panels();
    fmt::print("{:8} {:>9} {:10} {:10.3f} {:9.3f} {:5.1f} % {:10} {:8} {:5.2f} {:5.2f}\n", "sphere",
               fmt::format("{}x{}", units, slices), lattice, whole, measured,
               100.0 * measured / whole, triangles, fit->to_target.samples, fit->to_target.mean_mm,
               fit->to_target.p95_mm);
  }
}

TEST_CASE("how near each lattice comes to its target, and auto", "[bench]") {
  fmt::print(
      "structure to target mean | target to structure mean, mm; length 100, min_panel_mm 0.5\n");
  fmt::print("{:8} {:>7} {:>13} {:>13} {:>13} {:>13} {:>13} {:>13}  taken, s\n", "target", "N x Ns",
             "slices", "branching", "levels", "conformal", "direct", "auto");
  for (const auto& [name, radius] :
       {std::pair{"sphere", "sqrt(70^2-(y-50)^2)"}, std::pair{"saddle", "sqrt(45^2+(y-50)^2)"},
        std::pair{"wave", "55+8*sin(2*pi*y/50)"}})
    for (const int units : {5, 10, 20, 40}) {
      const auto spec = value(parse_design_spec(fmt::format(
          R"j({{"popcut":1,"surface":{{"type":"revolution","radius":"{}"}},"units_per_slice":{},
               "slices":{},"widths_mm":{},"min_panel_mm":0.5,"lattice":"auto"}})j",
          radius, units, 2 * units, 50.0 / units)));
      DesignReport r;
      const double seconds = seconds_of([&] {
        auto result = value(design(spec));
        r = std::move(result.report);
      });
      fmt::print("{:8} {:>7}", name, fmt::format("{}x{}", units, 2 * units));
      const auto show = [](const LatticeTrial& t) {
        fmt::print(" {:>13}", t.laid ? fmt::format("{:.2f}|{:.2f}", t.to_target_mean_mm,
                                                   t.to_structure_mean_mm)
                                     : std::string("-"));
      };
      for (const LatticeTrial& t : r.lattices) show(t);
      for (const LatticeTrial& t : r.lattices)
        if (t.lattice == r.lattice) show(t);
      fmt::print("  {}, {:.2f}\n", r.lattice, seconds);
    }
}

namespace {

/// A sphere of 100 mm as one run of slices with their chains.
RunTarget sphere_target(int units, int slices) {
  RunTarget target;
  target.units = units;
  target.min_panel_mm = 10.0 / units;
  const double width = 0.8 / slices;
  const auto radius = [](double y) { return 100.0 * std::sqrt(1.05 - y * y); };
  const auto points = static_cast<std::size_t>(units) + 1;
  target.chain_x.resize(points * static_cast<std::size_t>(slices));
  target.chain_z.resize(target.chain_x.size());
  ChainSolver solver;
  for (int j = 0; j < slices; ++j) {
    const double r = radius(width * j), between = radius(width * (j + 0.5));
    target.slice_curves.emplace_back(r, r);
    target.slice_s_mm.push_back(100.0 * width * j);
    target.slice_width_mm.push_back(100.0 * width);
    if (j + 1 < slices) {
      target.connector_curves.emplace_back(between, between);
      target.connector_s_mm.push_back(100.0 * width * (j + 0.5));
    }
    const std::size_t at = points * static_cast<std::size_t>(j);
    REQUIRE(solver.solve(target.slice_curves.back(), units,
                         std::span(target.chain_x.data() + at, points),
                         std::span(target.chain_z.data() + at, points)));
  }
  return target;
}

}  // namespace

TEST_CASE("seconds of a direct lattice", "[bench]") {
  fmt::print("direct on the sphere      unknowns    steps          s   ms a step\n");
  for (const auto& [units, slices] :
       {std::pair{20, 60}, std::pair{50, 200}, std::pair{100, 1000}}) {
    const RunTarget target = sphere_target(units, slices);
    DirectEffort effort;
    const double seconds = seconds_of([&] { REQUIRE(lattice_direct(target, &effort)); });
    fmt::print("{:4} x {:4}               {:9} {:8} {:10.3f} {:11.3f}\n", units, slices,
               effort.unknowns, effort.steps, seconds, 1e3 * seconds / effort.steps);
  }
}

TEST_CASE("time of a Gauss-Newton step over the units", "[bench]") {
  fmt::print("conformal on the sphere   unknowns    steps   ms a step   us a step and unknown\n");
  for (const auto& [units, slices] : {std::pair{10, 50}, std::pair{20, 50}, std::pair{20, 100},
                                      std::pair{50, 100}, std::pair{50, 200}, std::pair{50, 400}}) {
    const RunTarget target = sphere_target(units, slices);
    ConformalEffort effort;
    const double seconds =
        seconds_of([&] { REQUIRE(lattice_conformal(target, std::nullopt, &effort)); });
    fmt::print("{:4} x {:4}               {:9} {:8} {:11.3f} {:14.3f}  {:.3f} s\n", units, slices,
               effort.unknowns, effort.steps, 1e3 * seconds / effort.steps,
               1e6 * seconds / effort.steps / effort.unknowns, seconds);
  }
}

}  // namespace design_bench
