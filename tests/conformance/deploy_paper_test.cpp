// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <numbers>
#include <sstream>
#include <string>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "core/deploy/loaded_pattern.hpp"
#include "core/deploy/pose_table.hpp"
#include "core/deploy/sheet_mesh.hpp"
#include "core/deploy/stl.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/value.hpp"

namespace deploy_paper_test {

using namespace popcut;

namespace {

// The table and four meshes published with the paper (its code repository, sample of the inverted
// sphere); they are not shipped with popcut.
const std::string kPublished = popcut::testing::source_file("../shared/data/paper/inverted_sphere");

std::string text_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::vector<std::array<double, 3>> corners_of_text_stl(const std::string& text) {
  std::vector<std::array<double, 3>> corners;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    if (word != "vertex") continue;
    std::array<double, 3> p{};
    words >> p[0] >> p[1] >> p[2];
    corners.push_back(p);
  }
  return corners;
}

}  // namespace

TEST_CASE("the meshes published with the paper are reproduced vertex for vertex",
          "[core][deploy]") {
  if (!std::filesystem::exists(kPublished + ".csv")) {
    WARN("skipped: the paper's table is not here");
    return;
  }
  const auto panels =
      testing::value(read_segments_csv(text_of(kPublished + ".csv"), SegmentConvention::Paper));
  CHECK(panels.size() == 116);
  const Pattern pattern = pattern_from_segments(panels, "inverted sphere");
  const SheetMesh mesh = rectangle_mesh(pattern);
  const auto angles = opening_angles(0, std::numbers::pi / 2, 60);
  const auto table = testing::value(pose_table(pattern, *angles));
  for (const std::size_t frame : {1U, 20U, 40U, 60U}) {
    CAPTURE(frame);
    const auto due =
        corners_of_text_stl(text_of(fmt::format("{}_psi_{:03}.stl", kPublished, frame)));
    REQUIRE(due.size() == 3 * 232);
    std::ostringstream out;
    write_stl(mesh, table, frame - 1, MeshAxes::Paper, "", out);
    const std::string bytes = out.str();
    double off = 0;
    for (std::size_t i = 0; i < due.size(); ++i) {
      std::array<float, 3> p{};
      std::memcpy(p.data(), bytes.data() + 84 + 50 * (i / 3) + 12 * (1 + i % 3), 12);
      for (std::size_t c = 0; c < 3; ++c)
        off = std::max(off, std::abs(static_cast<double>(p[c]) - due[i][c]));
    }
    // Half a step of a float at 20 and half a digit of the published text.
    CHECK(off < 2e-6);
  }
}

}  // namespace deploy_paper_test
