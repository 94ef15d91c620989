// SPDX-License-Identifier: MIT
#include <catch2/catch.hpp>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <sstream>
#include <utility>
#include <vector>

#include "protocol/decode.hpp"
#include "protocol/encode.hpp"
#include "tests/support/moves.hpp"
#include "tests/support/other_replies.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/protocol_samples.hpp"

namespace protocol_captures_test {

using namespace popcut;
using namespace popcut::samples;

// What hosts sent to real machines, recorded at the USB bus: a Cameo 3 (firmware V1.60), a Portrait
// (V1.00) and a Cameo 1 or 2. The recordings are not part of this repository.
namespace {

const std::filesystem::path kFolder = popcut::testing::source_file("../shared/captures");

std::optional<std::string> capture(const std::string& name) {
  std::ifstream file(kFolder / name, std::ios::binary);
  if (!file) {
    WARN("skipped: there is no capture " << name);
    return std::nullopt;
  }
  return std::string(std::istreambuf_iterator<char>(file), {});
}

/// What is left of a host's bytes without queries, resets and empty commands: the program.
std::string without_queries(const std::string& bytes) {
  std::string rest;
  const Program program = decode(Dialect::Gpgl, bytes_of(bytes)).value();
  for (const Command& command : program.commands) {
    if (command.verb != Verb::Query && command.verb != Verb::Initialise &&
        command.verb != Verb::Empty)
      rest += bytes.substr(command.begin, command.end - command.begin);
  }
  return readable(bytes_of(rest));
}

std::string geometry(const Program& program) {
  std::ostringstream text;
  const PenMoves pen = moves(program);
  for (const PenStroke& stroke : pen.strokes) {
    for (std::uint32_t k = 0; k < stroke.count; ++k) {
      const MachinePoint point = pen.points[stroke.first + k];
      text << (k == 0 ? "" : " ") << point.a << ',' << point.b;
    }
    text << '\n';
  }
  return text.str();
}

constexpr const char* kSquares =
    "0,20 0,0 508,0 508,508 0,508 0,0 20,0\n"
    "0,5608 0,5588 508,5588 508,6096 0,6096 0,5588 20,5588\n"
    "5588,20 5588,0 6096,0 6096,508 5588,508 5588,0 5608,0\n"
    "5588,5608 5588,5588 6096,5588 6096,6096 5588,6096 5588,5588 5608,5588\n";
constexpr const char* kTriangle =
    "175.24,577.08 157.96,587.14 678.7,884.62 675.96,284.92 157.96,587.14 175.32,597.06\n";

const std::map<std::string, std::string> kGeometry{
    {"doc_tri_fwd", kTriangle},
    {"doc_tri_fwdp50mm", kTriangle},
    {"la_silhouette_box_thickness_1", "508,508 1016,508 1016,1016 508,1016 508,508\n"},
    {"la_silhouette_connect_only", ""},
    {"silhouette_cameo3_autoblade_depth5", kSquares},
    {"silhouette_cameo3_default_settings", kSquares},
    {"silhouette_cameo3_line_segment_overcut", kSquares},
    {"silhouette_cameo3_pen", kSquares},
    {"silhouette_cameo3_tool_2", kSquares},
    {"umockdev_cameo3", ""},
};

const Mat kMat{"12x12", 1, 304.8, 304.8};

/// The whole program of popcut for the job of a capture is what its host sent.
void check_same_program(const std::string& name, const Toolpath& toolpath, const Machine& machine,
                        const Material& material, const JobOptions& options) {
  const std::optional<std::string> sent = capture(name + ".out");
  if (!sent) return;
  const EncodedProgram program = encode(toolpath, machine, material, options).value();
  CHECK(readable(program.view()) == without_queries(*sent));
}

}  // namespace

TEST_CASE("every command of every recorded host stream is understood", "[protocol][conformance]") {
  for (const auto& [name, expected] : kGeometry) {
    CAPTURE(name);
    const std::optional<std::string> bytes = capture(name + ".out");
    if (!bytes) continue;
    const Program program = decode(Dialect::Gpgl, bytes_of(*bytes)).value();
    CHECK_FALSE(program.truncated);
    for (const Command& command : program.commands) CHECK(command.verb != Verb::Unknown);
    CHECK(geometry(program) == expected);
    CHECK(guess_dialect(bytes_of(*bytes)) == Dialect::Gpgl);
  }
}

TEST_CASE("no recorded host stream is left out of the comparison", "[protocol][conformance]") {
  if (!std::filesystem::is_directory(kFolder)) {
    WARN("skipped: there are no captures");
    return;
  }
  for (const auto& entry : std::filesystem::directory_iterator(kFolder))
    if (entry.path().extension() == ".out")
      CHECK(kGeometry.count(entry.path().stem().string()) == 1);
}

TEST_CASE("popcut sends a Cameo 3 the same bytes as its own software", "[protocol][conformance]") {
  Toolpath squares = four_squares();
  Material material = paper();
  JobOptions options = on_mat(kMat);
  SECTION("by default") {
    check_same_program("silhouette_cameo3_default_settings", squares, cameo3(), material, options);
  }
  SECTION("with the autoblade at 5") {
    material.autoblade_depth = 5;
    check_same_program("silhouette_cameo3_autoblade_depth5", squares, cameo3(), material, options);
  }
  SECTION("with corners lifted") {
    options.corner_lift = true;
    check_same_program("silhouette_cameo3_line_segment_overcut", squares, cameo3(), material,
                       options);
  }
  SECTION("with the second holder") {
    for (Stroke& stroke : squares.strokes) stroke.tool = 2;
    check_same_program("silhouette_cameo3_tool_2", squares, cameo3(), material, options);
  }
  SECTION("with a pen") {
    options.autoblade = false;
    for (Stroke& stroke : squares.strokes) {
      stroke.operation = Operation::Draw;
      stroke.speed_mm_s = 1000;
      stroke.force_gf = 126;
    }
    check_same_program("silhouette_cameo3_pen", squares, cameo3(), material, options);
  }
}

TEST_CASE("popcut sends a Portrait the same bytes as its own software", "[protocol][conformance]") {
  Toolpath box;
  Stroke& stroke =
      add_stroke(box, {{25.4, 25.4}, {25.4, 50.8}, {50.8, 50.8}, {50.8, 25.4}, {25.4, 25.4}});
  stroke.force_gf = 7;
  stroke.speed_mm_s = 300;
  JobOptions options{.page_width_mm = 206, .page_length_mm = 277.9};
  options.window_left_mm = options.window_top_mm = 1.5;
  check_same_program("la_silhouette_box_thickness_1", box, one_holder("gpgl", "classic"), paper(),
                     options);
}

TEST_CASE("popcut writes fractions as recorded for a classic machine", "[protocol][conformance]") {
  const std::optional<std::string> sent = capture("doc_tri_fwd.out");
  if (!sent) return;
  Toolpath triangle;
  add_stroke(triangle, {{577.08 * 0.05, 175.24 * 0.05},
                        {587.14 * 0.05, 157.96 * 0.05},
                        {884.62 * 0.05, 678.70 * 0.05},
                        {284.92 * 0.05, 675.96 * 0.05},
                        {587.14 * 0.05, 157.96 * 0.05},
                        {597.06 * 0.05, 175.32 * 0.05}});
  const EncodedProgram program =
      encode(triangle, one_holder("gpgl", "classic"), paper(), JobOptions{.fractions = true})
          .value();
  CHECK_THAT(without_queries(*sent), Catch::Contains(readable(program.view(program.geometry))));
}

TEST_CASE("recorded replies are read with their known values", "[protocol][conformance]") {
  for (const std::string name :
       {"silhouette_cameo3_default_settings", "la_silhouette_connect_only"}) {
    const std::optional<std::string> bytes = capture(name + ".in");
    if (!bytes) continue;
    std::map<DeviceStatus, int> statuses;
    std::vector<std::string> models;
    std::vector<std::pair<double, double>> pairs;
    std::istringstream replies(*bytes);
    for (std::string reply; std::getline(replies, reply, '\x03');) {
      const Result<NumberPair> pair = parse_pair(reply);
      const Result<Identity> identity = parse_identity(reply);
      const DeviceStatus status = parse_status(reply);
      if (status != DeviceStatus::Unknown)
        ++statuses[status];
      else if (pair)
        pairs.emplace_back(pair->first, pair->second);
      else if (identity && !identity->firmware.empty())
        models.push_back(identity->model + " " + identity->firmware);
    }
    if (name == "silhouette_cameo3_default_settings") {
      CHECK(statuses ==
            std::map<DeviceStatus, int>{{DeviceStatus::Ready, 75}, {DeviceStatus::Moving, 68}});
      CHECK(models == std::vector<std::string>{"CAMEO 3 V1.60"});
      CHECK(pairs == std::vector<std::pair<double, double>>{{0, 0}, {0, 0}, {0, 0}});
    } else {
      CHECK(statuses[DeviceStatus::NoMedia] > 0);
      CHECK(models == std::vector<std::string>{"Portrait V1.00"});
      CHECK(std::count(pairs.begin(), pairs.end(), std::pair<double, double>{6100, 4120}) == 1);
    }
  }
}

}  // namespace protocol_captures_test
