// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <Eigen/Dense>
#include <catch2/catch.hpp>

#include "core/design/chain/slicing.hpp"
#include "core/design/design.hpp"
#include "core/design/lattice/band_cholesky.hpp"
#include "core/design/lattice/panel_error.hpp"
#include "core/design/run_layout.hpp"
#include "tests/support/value.hpp"

namespace lattice_direct_test {

using namespace popcut;

namespace {

DesignSpec parsed(const std::string& surface, int units, int slices, double width_mm,
                  const std::string& more) {
  return testing::value(parse_design_spec(fmt::format(
      R"j({{"popcut":1,"surface":{{{}}},"units_per_slice":{},"slices":{},"widths_mm":{}{}}})j",
      surface, units, slices, width_mm, more)));
}

RunTarget target_of(const DesignSpec& spec) {
  const auto sliced = testing::value(slice_target(spec, {}));
  RunLayout layout = lay_runs(sliced, sliced.cut_after, spec);
  return std::move(layout.targets.front());
}

const std::string kSphere = R"j("type":"revolution","radius":"sqrt(70^2-(y-50)^2)")j";
const std::string kSaddle = R"j("type":"revolution","radius":"sqrt(45^2+(y-50)^2)")j";
const std::string kWave = R"j("type":"revolution","radius":"55+8*sin(2*pi*y/50)")j";
const std::string kProfile = R"j("type":"profile","z":"60*(1-(x/(50+0.2*y))^2)")j";

const LatticeTrial& trial_of(const DesignReport& report, const std::string& name) {
  const auto it = std::find_if(report.lattices.begin(), report.lattices.end(),
                               [&](const LatticeTrial& t) { return t.lattice == name; });
  REQUIRE(it != report.lattices.end());
  return *it;
}

}  // namespace

TEST_CASE("a band factor solves what a dense factor solves", "[core][lattice]") {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> real(-1.0, 1.0);
  for (const auto& [size, band] :
       {std::pair{1, 1}, std::pair{2, 5}, std::pair{31, 3}, std::pair{33, 32}, std::pair{64, 63},
        std::pair{100, 1}, std::pair{150, 40}, std::pair{200, 70}}) {
    CAPTURE(size, band);
    Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(size, size);
    BandCholesky banded(size, band);
    for (int c = 0; c < size; ++c)
      for (int r = c; r < std::min(size, c + band + 1); ++r) {
        const double value = r == c ? 2.5 * band + 1.0 : real(random);
        dense(r, c) = dense(c, r) = value;
        banded.add(r, c, value);
      }
    std::vector<double> x;
    for (int k = 0; k < size; ++k) x.push_back(real(random));
    const Eigen::VectorXd wanted =
        dense.llt().solve(Eigen::Map<const Eigen::VectorXd>(x.data(), size));
    REQUIRE(banded.factorize());
    banded.solve(x);
    for (int k = 0; k < size; ++k)
      CHECK_THAT(x[static_cast<std::size_t>(k)], Catch::WithinAbs(wanted[k], 1e-12));
  }
}

TEST_CASE("a band matrix that is not positive definite has no factor", "[core][lattice]") {
  for (const int bad : {0, 5, 40, 79}) {
    BandCholesky banded(80, 35);
    for (int k = 0; k < 80; ++k) banded.add(k, k, k == bad ? -1.0 : 1.0);
    CHECK_FALSE(banded.factorize());
  }
}

TEST_CASE("the derivatives of a panel's error are those of its values", "[core][lattice]") {
  const std::string surface = GENERATE(kSphere, kProfile);
  const RunTarget target = target_of(parsed(surface, 6, 9, 5, ""));
  const PanelError error(target);
  std::mt19937 random(11);
  std::uniform_real_distribution<double> real(0.0, 1.0);
  for (int k = 0; k < 200; ++k) {
    const int strip = static_cast<int>(real(random) * error.strips());
    const SectionPoint on = error.section(strip).at(-0.9 + 1.8 * real(random));
    const bool level = real(random) < 0.5;
    const double along = level ? on.x : on.z, across = level ? on.z : on.x;
    const std::vector<double> p{along - 4.0 * real(random), along + 4.0 * real(random),
                                across + 2.0 * real(random) - 1.0};
    const Panel panel{{0, 0.0}, {1, 0.0}, {2, 0.0}, strip, level};
    const PanelError::Jet jet = error.jet(panel, p);
    CHECK_THAT(jet.value, Catch::WithinRel(error.value(panel, p), 1e-12));
    // How steep the target is along the spine changes little over a panel and is held fixed: exact
    // for revolutions, else to some percent.
    const double tolerance = surface == kSphere ? 1e-5 : 0.05;
    double scale = 0.0;
    for (const double first : jet.first) scale = std::max(scale, std::abs(first));
    for (std::size_t i = 0; i < 3; ++i) {
      std::vector<double> above = p, below = p;
      above[i] += 1e-5, below[i] -= 1e-5;
      const double slope = (error.value(panel, above) - error.value(panel, below)) / 2e-5;
      CAPTURE(strip, level, i, jet.value);
      CHECK_THAT(jet.first[i], Catch::WithinAbs(slope, tolerance * scale + 1e-6));
    }
  }
}

TEST_CASE("the planes of a direct lattice are in order and min_panel_mm apart", "[core][lattice]") {
  const std::string surface = GENERATE(kSphere, kSaddle, kWave, kProfile);
  const auto [units, slices] = GENERATE(std::pair{2, 6}, std::pair{5, 10}, std::pair{20, 40});
  CAPTURE(surface, units, slices);
  const RunTarget target = target_of(parsed(surface, units, slices, 100.0 / slices, ""));
  DirectEffort effort;
  const auto planes = testing::value(lattice_direct(target, &effort));
  CHECK(effort.steps < 120);
  for (int k = 0; k + 1 < slices; ++k) {
    int first = 0, last = units;
    for (int i = 0; i <= units; ++i)
      if (planes.vertex(k, i).x == 0.0) first = i;
    for (int i = units; i > first; --i)
      if (planes.vertex(k, i).z == 0.0) last = i;
    CHECK(first < last);
    for (int i = first + 1; i <= last; ++i) {
      CAPTURE(k, i);
      const SectionPoint a = planes.vertex(k, i - 1), b = planes.vertex(k, i);
      CHECK(b.x - a.x >= target.min_panel_mm);
      CHECK(a.z - b.z >= target.min_panel_mm);
    }
  }
}

TEST_CASE("a direct lattice loses few levels to min_panel_mm", "[core][design][lattice]") {
  // Steps a hair too short would cost some hundred places here.
  const auto made =
      design(parsed(kSphere, 24, 40, 2.5, R"(,"lattice":"direct","min_panel_mm":1.2)"));
  if (!made) FAIL(message(made.error()));
  CAPTURE(made->report.merged.size());
  CHECK(made->report.merged.size() < 24);
}

TEST_CASE("a direct lattice is the same in every run", "[core][lattice]") {
  const RunTarget target = target_of(parsed(kWave, 9, 15, 6, ""));
  CHECK(lattice_direct(target)->value == lattice_direct(target)->value);
}

TEST_CASE("a direct lattice whose matrix would fill the memory is refused", "[core][lattice]") {
  RunTarget target;
  target.units = 1400;
  target.slice_curves.assign(1400, SliceCurve(50.0, 50.0));
  target.connector_curves.assign(1399, SliceCurve(50.0, 50.0));
  target.chain_x.resize(1401 * 1400), target.chain_z.resize(target.chain_x.size());
  const auto planes = lattice_direct(target);
  REQUIRE_FALSE(planes);
  CHECK(planes.error().place == "/lattice");
}

TEST_CASE("auto takes the lattice with the smallest two-sided rms and reports all five",
          "[core][design][lattice]") {
  const std::string surface = GENERATE(kSphere, kSaddle, kWave, kProfile);
  const auto made = testing::value(design(parsed(surface, 8, 12, 8, R"(,"lattice":"auto")")));
  const DesignReport& report = made.report;
  REQUIRE(report.lattices.size() == 5);
  CHECK(report.lattice_asked == "auto");
  const double taken = trial_of(report, report.lattice).two_sided_rms_mm;
  for (const LatticeTrial& trial : report.lattices) {
    CAPTURE(trial.lattice, trial.reason);
    CHECK((!trial.laid || !trial.reason.empty() || taken <= trial.two_sided_rms_mm));
  }
  CHECK(trial_of(report, "direct").two_sided_rms_mm < trial_of(report, "slices").two_sided_rms_mm);
}

TEST_CASE("more units do not drive auto away from its target", "[core][design][lattice]") {
  // The conformal lattice alone ends 5 mm off here on average, nearly a plane.
  double last = 2.0;
  for (const int units : {10, 20}) {
    const auto made = testing::value(design(
        parsed(kSphere, units, 2 * units, 50.0 / units, R"(,"lattice":"auto","min_panel_mm":1)")));
    const double rms = trial_of(made.report, made.report.lattice).two_sided_rms_mm;
    CHECK(rms < 0.75 * last);
    CHECK(made.report.degrees_of_freedom == 1);
    last = rms;
  }
}

TEST_CASE("a max_step_over_mean that was asked for binds auto", "[core][design][lattice]") {
  const auto made =
      design(parsed(kSphere, 8, 12, 8, R"(,"lattice":"auto","max_step_over_mean":1.3)"));
  if (!made) FAIL(message(made.error()));
  CHECK(made->report.lattice == "conformal");
  CHECK(made->report.step_over_mean_max <= 1.3 * (1.0 + 1e-9));
  const bool refused = std::any_of(
      made->report.lattices.begin(), made->report.lattices.end(), [](const LatticeTrial& t) {
        return t.reason.find("max_step_over_mean = 1.3") != std::string::npos;
      });
  CHECK(refused);
}

}  // namespace lattice_direct_test
