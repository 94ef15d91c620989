// SPDX-License-Identifier: MIT
// The depth of an autoblade is set only where there is one.
#include <string>

#include <catch2/catch.hpp>

#include "device/session/session.hpp"
#include "tests/support/sim_bench.hpp"

namespace session_blade_test {

using namespace popcut;
using namespace popcut::testing;

namespace {

/// A cable that keeps what was sent.
class Kept final : public Transport {
 public:
  Kept(SimTransport& cable, bool mute) : cable_(cable), mute_(mute) {}
  WriteEnd write(std::span<const std::byte> bytes, Deadline until) override {
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (mute_ && text == kToolsQuery) return {bytes.size(), std::nullopt};
    const WriteEnd end = cable_.write(bytes, until);
    for (const std::byte byte : bytes.first(end.taken)) sent += static_cast<char>(byte);
    return end;
  }
  Result<std::vector<std::byte>> read(Deadline until) override { return cable_.read(until); }
  [[nodiscard]] std::chrono::nanoseconds now() const override { return cable_.now(); }
  void wait(std::chrono::nanoseconds duration) override { cable_.wait(duration); }

  std::string sent{};

 private:
  SimTransport& cable_;
  bool mute_;  ///< it does not answer which tools it has
};

/// Ten lines with a pen in the second holder, then ten with the blade in the first.
Toolpath drawn_and_cut() {
  Toolpath path;
  for (std::uint32_t k = 0; k < 20; ++k) {
    const double y = 5 + 4 * static_cast<double>(k);
    path.points.insert(path.points.end(), {{10, y}, {60, y}});
    Stroke stroke;
    stroke.first = 2 * k;
    stroke.count = 2;
    stroke.line = k;
    stroke.tool = k < 10 ? 2 : 1;
    stroke.operation = k < 10 ? Operation::Draw : Operation::Cut;
    stroke.force_gf = 70;
    stroke.speed_mm_s = 50;
    path.strokes.push_back(stroke);
  }
  return path;
}

struct Run {
  SessionEnd end;
  std::string sent;
  std::size_t strokes{};  ///< that the machine drew and cut
};

Run run(const Toolpath& path, std::vector<int> tools, bool ask, bool mute = false,
        std::size_t first = 0) {
  const Machine cameo = machine("cameo4");
  JobOptions options{.page_length_mm = 200};
  options.ask_blade = ask;
  auto program = value(encode(path, cameo, value(find_material("paper-220")), options));
  if (first > 0) program = value(rest_of(program, first));
  SimOptions sheet;
  sheet.page_length_mm = 200;
  sheet.tools = std::move(tools);
  SimTransport cable(cutter(cameo, sheet));
  Kept kept(cable, mute);
  SessionEnd end = run_session(kept, cameo, program);
  return {std::move(end), kept.sent, cable.cutter().trace().strokes.size()};
}

Toolpath only_cut() {
  Toolpath path = drawn_and_cut();
  for (Stroke& stroke : path.strokes) {
    stroke.tool = 1;
    stroke.operation = Operation::Cut;
  }
  return path;
}

std::size_t times(const std::string& text, std::string_view part) {
  std::size_t n = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
  return n;
}

}  // namespace

TEST_CASE("an autoblade that the machine reports is set to the material's depth",
          "[device][session]") {
  for (const Toolpath& path : {only_cut(), drawn_and_cut()}) {
    const Run autoblade = run(path, {2, 7}, true);
    REQUIRE(!autoblade.end.error);
    CHECK(times(autoblade.sent, "TF5,1\x03") == 1);
    CHECK(times(autoblade.sent, kToolsQuery) == 1);
    CHECK(autoblade.end.remarks.empty());
    CHECK(count(autoblade.end, StrokeFate::Certain) == 20);
  }
}

TEST_CASE("another blade than an autoblade is never tapped, unless a person says what it is",
          "[device][session]") {
  const Toolpath path = GENERATE(only_cut(), drawn_and_cut());
  const int tool = GENERATE(0, 1, 3, 4, 5, 7, 255);
  CAPTURE(tool);
  const Run other = run(path, {tool, 7}, true);
  REQUIRE(!other.end.error);
  CHECK(times(other.sent, "TF") == 0);
  CHECK(times(other.sent, "FC18,1,1\x03") == 1);
  REQUIRE(other.end.remarks.size() == 1);
  CHECK_THAT(other.end.remarks[0], Catch::Contains("first holder"));
  CHECK(count(other.end, StrokeFate::Certain) == 20);
  CHECK(other.strokes == 20);
  const Run said = run(path, {tool, 7}, false);
  CHECK(times(said.sent, "TF5,1\x03") == 1);
  CHECK(times(said.sent, kToolsQuery) == 0);
}

TEST_CASE("a machine that does not say which blade it has keeps its depth", "[device][session]") {
  const Run silent = run(only_cut(), {2, 7}, true, true);
  REQUIRE(!silent.end.error);
  CHECK(times(silent.sent, "TF") == 0);
  REQUIRE(silent.end.remarks.size() == 1);
  CHECK_THAT(silent.end.remarks[0], Catch::Contains("did not say"));
  CHECK(count(silent.end, StrokeFate::Certain) == 20);
}

TEST_CASE("the rest of a job asks for the blade again", "[device][session]") {
  const Run rest = run(drawn_and_cut(), {1, 7}, true, false, 12);
  REQUIRE(!rest.end.error);
  CHECK(times(rest.sent, kToolsQuery) == 1);
  CHECK(times(rest.sent, "TF") == 0);
  CHECK(rest.strokes == 8);
}

}  // namespace session_blade_test
