// SPDX-License-Identifier: MIT
// Mistakes that other drivers are known to make and that no other test shows to be absent; the list
// of all is docs/protocol-traps.md.
#include <catch2/catch.hpp>

#include <fmt/format.h>

#include "device/session/schedule.hpp"
#include "device/session/session.hpp"
#include "device/sim/simulate.hpp"
#include "protocol/be_delta.hpp"
#include "protocol/decode.hpp"
#include "tests/support/sim_bench.hpp"

namespace protocol_traps_test {

using namespace popcut;
using namespace popcut::testing;

namespace {

EncodedProgram some_job(const Machine& machine, std::size_t strokes = 30) {
  std::mt19937 random(11);
  const Material paper = value(find_material("paper-220"));
  JobOptions job;
  job.page_length_mm = 300;
  return value(encode(random_toolpath(random, strokes, 190, paper), machine, paper, job));
}

}  // namespace

TEST_CASE("the tool is put away once and only after everything is cut", "[protocol][traps]") {
  for (const char* name : {"cameo3", "cameo4", "cameo5", "cameo5-alpha", "cameo-pro-mk2"}) {
    CAPTURE(name);
    const EncodedProgram program = some_job(machine(name));
    const Program read = value(decode(Dialect::Gpgl, program.view()));
    std::size_t put_away = 0, chosen = 0;
    for (const Command& command : read.commands) {
      if (command.verb != Verb::SelectTool) continue;
      const bool none = read.args[command.first] == 0;
      ++(none ? put_away : chosen);
      if (none) CHECK(command.begin >= program.trailer.begin);
      if (!none) CHECK(command.begin < program.geometry.end);
    }
    CHECK(put_away == 1);
    CHECK(chosen >= 1);
  }
}

TEST_CASE("estimating and simulating a program sends nothing to a cutter", "[device][traps]") {
  // One reference driver's trial run really sends its trailer, which puts the tool away.
  const Machine cameo = machine("cameo3");
  const EncodedProgram program = some_job(cameo);
  SimTransport cable(cutter(cameo));
  CHECK(value(schedule(program, cameo, first_lines(program))).geometry_s > 0);
  CHECK(value(simulate(program.view(), cameo)).strokes.size() > 0);
  CHECK(cable.cutter().accepted_bytes() == 0);
}

TEST_CASE("machines with one holder never get a command to choose one", "[protocol][traps]") {
  for (const char* name : {"portrait3", "portrait4", "cameo", "cameo2", "portrait"}) {
    CAPTURE(name);
    const EncodedProgram program = some_job(machine(name));
    const Program read = value(decode(Dialect::Gpgl, program.view()));
    for (const Command& command : read.commands) CHECK(command.verb != Verb::SelectTool);
  }
}

TEST_CASE("every machine is parked at the end", "[protocol][traps]") {
  // A Cameo 2 that does not stand at the left refuses the next job.
  for (const Machine& each : value(all_machines())) {
    if (each.language != "gpgl") continue;
    CAPTURE(each.name);
    const EncodedProgram program = some_job(each, 5);
    const std::string trailer(program.bytes.substr(program.trailer.begin));
    CHECK(trailer.find("M0,0\x03") != std::string::npos);
  }
}

TEST_CASE("no command that calibrates a machine permanently is ever sent", "[protocol][traps]") {
  for (const Machine& each : value(all_machines())) {
    if (!each.driven()) continue;
    CAPTURE(each.name);
    const EncodedProgram program = some_job(each, 5);
    for (const char* word : {"FB", "TB70", "TB72"})
      CHECK(program.bytes.substr(0, program.geometry.begin).find(word) == std::string::npos);
  }
}

TEST_CASE("the landscape orientation that parks the head on the other side is never sent",
          "[protocol][traps]") {
  for (const char* name : {"cameo", "cameo2", "cameo3", "cameo4", "portrait3"}) {
    const EncodedProgram program = some_job(machine(name), 5);
    const Program read = value(decode(Dialect::Gpgl, program.view()));
    for (const Command& command : read.commands)
      if (command.verb == Verb::Orientation) CHECK(read.args[command.first] == 0);
  }
}

TEST_CASE("a long job does not wait for ready between its settings", "[device][traps]") {
  // One reference driver waits for ready after every kilobyte: the tool then stands still in the
  // middle of a line. Here the buffer never runs dry with the tool down.
  const Machine cameo = machine("cameo3");
  const Material paper = value(find_material("paper-220"));
  Toolpath path;
  Stroke stroke;
  stroke.count = 3000;
  stroke.force_gf = paper.cut.force_gf;
  stroke.speed_mm_s = paper.cut.speed_mm_s;
  for (int k = 0; k < 3000; ++k)
    path.points.push_back({10 + k % 2 * 3.0 + k / 60 * 5.0, 10 + k % 60 * 4.0});
  path.strokes.push_back(stroke);
  const EncodedProgram program = value(encode(path, cameo, paper, {}));
  REQUIRE(program.bytes.size() > 5000);
  SimTransport cable(cutter(cameo));
  const SessionEnd end = run_session(cable, cameo, program);
  REQUIRE_FALSE(end.error);
  CHECK(cable.cutter().trace().starved_s == 0.0);
  CHECK(cable.cutter().trace().strokes.size() == 1);
}

TEST_CASE("the longest deltas of each binary form are written and read back", "[protocol][traps]") {
  for (const DeltaForm& form : kDeltaForms) {
    const std::int64_t most = form.half - 1;
    for (const std::int64_t feed : {-most, std::int64_t{0}, most})
      for (const std::int64_t carriage : {-most, std::int64_t{0}, most}) {
        std::string text;
        put_delta(form, feed, carriage, [&](char c) { text += c; });
        CAPTURE(form.number, feed, carriage);
        CHECK(text.size() == static_cast<std::size_t>(form.digits));
        for (const char c : text) CHECK(static_cast<unsigned char>(c) >= kDeltaZero);
        const Program read =
            value(decode(Dialect::Gpgl, bytes("M1000000,1000000\x03"
                                              "BE" +
                                              std::to_string(form.number) + text + "\x03")));
        REQUIRE(read.points.size() == 2);
        CHECK(read.points[1].a == 1e6 + static_cast<double>(feed));
        CHECK(read.points[1].b == 1e6 + static_cast<double>(carriage));
      }
    CHECK(shortest_form(most, -most)->number == form.number);
  }
  CHECK(kDeltaForms[0].half - 1 == 111);
  CHECK(kDeltaForms[1].half - 1 == 1675);
  CHECK(kDeltaForms[2].half - 1 == 375481);
  CHECK(shortest_form(375482, 0) == nullptr);
}

}  // namespace protocol_traps_test
