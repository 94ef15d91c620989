// SPDX-License-Identifier: MIT
// The closed form, as the generator writes it into FOLD frames, and the general rigid-panel solver,
// which sees the flat sheet alone, must agree.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <random>
#include <sstream>
#include <string>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "core/design/design.hpp"
#include "core/formats/fold/fold_writer.hpp"
#include "core/verify/motion/mobility.hpp"
#include "core/verify/motion/motion.hpp"
#include "core/verify/motion/opening.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/value.hpp"
#include "tests/support/verify_drafts.hpp"

namespace verify_opening_property_test {

using namespace popcut;
using namespace popcut::testing;

namespace {

constexpr double kPi = std::numbers::pi;

std::string example(const std::string& name) {
  std::ifstream in(popcut::testing::source_file("examples/") + name + ".json");
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

/// The FOLD file of a design with frames at pi/2 and 1.1.
std::string fold_of(const std::string& spec_text) {
  const auto made = value(design(value(parse_design_spec(spec_text))));
  std::ostringstream fold;
  FoldOptions options;
  options.psi_rad = std::vector{kPi / 2.0, 1.1};
  REQUIRE(write_fold(made.pattern, options, fold));
  return fold.str();
}

struct Agreement {
  double off_mm{};
  std::size_t iterations{};
  std::size_t freedoms_by_loops{}, freedoms_by_panels{};
};

/// Takes the frames off, opens the rest and compares with what was taken off.
Agreement compared(const std::string& fold, bool keep_angles) {
  auto file = value(verify::read_fold_model(fold));
  const std::vector<verify::Pose> known = std::move(file.poses);
  REQUIRE(known.size() == 2);
  file.poses.clear();
  if (!keep_angles) file.fold_angle_deg.clear();
  VerifyCheck check;
  const verify::Sheet sheet = make_sheet(file, check);
  const double psi[] = {kPi / 2.0, 1.1};
  const verify::Trajectory opening = open_sheet(file, sheet, psi, 1e-9);
  INFO(opening.stopped);
  REQUIRE(opening.poses.size() == 2);
  CHECK(opening.reversed == 0);
  CHECK(opening.notes.empty());
  Agreement result;
  result.iterations = opening.iterations;
  for (std::size_t k = 0; k < 2; ++k) {
    CHECK(*opening.poses[k].psi_rad == Approx(*known[k].psi_rad));
    result.off_mm =
        std::max(result.off_mm, largest_difference(file, sheet, opening.poses[k], known[k]));
  }
  const auto pose = measure(file, sheet, make_panels(file, sheet), opening.poses[1]);
  result.freedoms_by_loops = mobility(file, sheet, pose, 1e-12).degrees_of_freedom;
  result.freedoms_by_panels =
      mobility(file, sheet, pose, 1e-12, verify::MobilityForm::Panels).degrees_of_freedom;
  return result;
}

}  // namespace

TEST_CASE("closed form and general solver agree to 1e-9 mm on every splayed example",
          "[core][verify][splay][property]") {
  for (const std::string name : {"facade", "multistate"}) {
    const std::string fold = fold_of(example(name));
    for (const bool angles : {true, false}) {
      CAPTURE(name, angles);
      const Agreement found = compared(fold, angles);
      CAPTURE(found.iterations);
      CHECK(found.off_mm < 1e-9);               // 2e-13 mm were seen
      CHECK((angles || found.iterations > 0));  // without angles the guess is wrong at first
      CHECK(found.freedoms_by_loops == 1);
      CHECK(found.freedoms_by_panels == 1);
    }
  }
}

TEST_CASE("closed form and general solver agree to 1e-9 mm on every rectangular example",
          "[core][verify][property]") {
  for (const std::string name :
       {"unit", "fig2a", "cylinder", "sphere", "saddle", "composite", "airfoil", "packaging"}) {
    const std::string fold = fold_of(example(name));
    for (const bool angles : {true, false}) {
      CAPTURE(name, angles);
      const Agreement found = compared(fold, angles);
      CHECK(found.off_mm < 1e-9);
      CHECK(found.freedoms_by_loops == 1);
      CHECK(found.freedoms_by_panels == 1);
    }
  }
}

TEST_CASE("random splayed cards open from their assignments alone as the closed form predicts",
          "[core][verify][splay][property]") {
  const unsigned seed = 20261121;
  std::mt19937 random(seed);
  for (int round = 0; round < 12; ++round) {
    const double alpha = std::uniform_real_distribution<double>(0.2, 1.3)(random);
    const int slices = 2 + static_cast<int>(random() % 4);
    CAPTURE(seed, round, alpha, slices);
    const std::string spec = fmt::format(
        R"j({{"popcut":1,"surface":{{"type":"profile","z":"75-x"}},"units_per_slice":3,"slices":{},
             "widths_mm":15,"lattice":"slices","splay":{{"alpha":{:.4f}}}}})j",
        slices, alpha);
    const auto parsed = value(parse_design_spec(spec));
    const Agreement found = compared(fold_of(spec), false);
    CHECK(found.off_mm < 1e-9);
    CHECK(found.freedoms_by_loops == 1);
  }
}

}  // namespace verify_opening_property_test
