// SPDX-License-Identifier: MIT
#include <catch2/catch.hpp>

#include "device/session/session.hpp"
#include "device/sim/sim_faults.hpp"
#include "tests/support/sim_bench.hpp"

namespace sim_faults_test {

using namespace popcut;
using namespace popcut::testing;

namespace {

std::string error_of(std::string_view script) {
  const auto faults = parse_faults(script);
  return faults ? std::string("none") : message(faults.error());
}

struct Job : SimJob {
  Job() : Job(std::mt19937(7)) {}
  [[nodiscard]] SessionEnd run(SimTransport& cable) const {
    return run_session(cable, machine, program);
  }

 private:
  explicit Job(std::mt19937 random) : SimJob(testing::machine("cameo3"), random, 40) {}
};

}  // namespace

TEST_CASE("a fault script lists faults and when they strike", "[device][faults]") {
  const auto faults = value(parse_faults(R"({"popcut": 1, "faults": [
    {"at_byte": 800, "kind": "nak", "seconds": 3.5},
    {"at_path": 12, "kind": "media out"},
    {"kind": "wrong name", "text": "Portrait V1.00    "}]})"));
  REQUIRE(faults.size() == 3);
  CHECK(faults[0].kind == SimFault::Kind::Nak);
  CHECK(faults[0].at_byte == 800);
  CHECK(faults[0].seconds == 3.5);
  CHECK(faults[1].at_path == 12);
  CHECK(faults[2].text == "Portrait V1.00    ");
}

TEST_CASE("an invalid fault script is refused with its place", "[device][faults]") {
  CHECK_THAT(error_of("{"), Catch::Contains("1:"));
  CHECK_THAT(error_of("[]"), Catch::Contains("an object"));
  CHECK_THAT(error_of(R"({"popcut": 1})"), Catch::Contains("neither"));
  CHECK_THAT(error_of(R"({"popcut": 1, "faults": [{"at_byte": 1}]})"),
             Catch::Contains("/faults/0/kind"));
  CHECK_THAT(error_of(R"({"popcut": 1, "faults": [{"kind": "stal"}]})"),
             Catch::Contains("did you mean stall?"));
  CHECK_THAT(error_of(R"({"popcut": 1, "faults": [{"kind": "stall", "at_byte": -1}]})"),
             Catch::Contains("/faults/0/at_byte"));
  CHECK_THAT(
      error_of(R"({"popcut": 1, "faults": [{"kind": "stall", "at_path": 1, "at_byte": 1}]})"),
      Catch::Contains("give one of them"));
  CHECK_THAT(error_of(R"({"popcut": 1, "faults": [{"kind": "garbage"}]})"),
             Catch::Contains("/faults/0/text"));
  CHECK_THAT(error_of(R"({"popcut": 1, "faults": [{"kind": "stall", "when": 1}]})"),
             Catch::Contains("/faults/0/when"));
  CHECK_THAT(error_of(R"({"popcut": 1, "faults": [3]})"), Catch::Contains("/faults/0"));
}

TEST_CASE("random faults are the same for the same seed", "[device][faults]") {
  const auto draw = [](const char* text) { return value(parse_faults(text)); };
  const auto one = draw(R"({"popcut": 1, "random": {"seed": 7, "count": 20, "bytes": 9000}})");
  const auto two = draw(R"({"popcut": 1, "random": {"seed": 7, "count": 20, "bytes": 9000}})");
  const auto other = draw(R"({"popcut": 1, "random": {"seed": 8, "count": 20, "bytes": 9000}})");
  REQUIRE(one.size() == 20);
  bool differs = false;
  for (std::size_t k = 0; k < one.size(); ++k) {
    CHECK(one[k].kind == two[k].kind);
    CHECK(one[k].at_byte == two[k].at_byte);
    differs = differs || one[k].at_byte != other[k].at_byte;
  }
  CHECK(differs);
}

TEST_CASE("a fault at a path strikes when that path is being cut", "[device][faults]") {
  const Job job;
  SimFault fault{.kind = SimFault::Kind::MediaOut};
  fault.at_path = 12;
  SimTransport cable(cutter(job.machine), {fault});
  const SessionEnd end = job.run(cable);
  REQUIRE(end.error);
  CHECK(end.error->detail.find("sheet came out") != std::string::npos);
  CHECK(end.error->reason == ErrorReason::NoMedia);
  CHECK(cable.cutter().trace().strokes.size() == 12);
}

TEST_CASE("a stall ends the session and what may have arrived is in doubt", "[device][faults]") {
  const Job job;
  const std::uint64_t at = job.program.geometry.begin + 400;
  SimTransport cable(cutter(job.machine), {{.at_byte = at, .kind = SimFault::Kind::Stall}});
  const SessionEnd end = job.run(cable);
  REQUIRE(end.error);
  CHECK(end.error->kind == ErrorKind::Refused);
  CHECK(end.error->detail.find("stalled") != std::string::npos);
  CHECK(end.error->reason == ErrorReason::Stalled);
  cable.cutter().run_dry();
  const std::size_t begun = cable.cutter().trace().strokes.size();
  for (std::size_t k = 0; k < begun; ++k) CHECK(end.fates[k] != StrokeFate::NotSent);
  CHECK(end.fates.back() == StrokeFate::NotSent);
}

TEST_CASE("plugging a cutter in again does not revive the session that lost it",
          "[device][faults]") {
  const Job job;
  const std::uint64_t at = job.program.geometry.begin + 400;
  SimTransport cable(cutter(job.machine),
                     {{.at_byte = at, .kind = SimFault::Kind::Unplug, .seconds = 5}});
  const SessionEnd end = job.run(cable);
  REQUIRE(end.error);
  CHECK(end.error->kind == ErrorKind::DeviceGone);
  const std::uint64_t accepted = cable.cutter().accepted_bytes();
  cable.wait(std::chrono::seconds(60));
  CHECK(cable.cutter().accepted_bytes() == accepted);
  // It can be reached again, by a session of its own.
  CHECK(cable.write(bytes("\x1b\x05"), cable.now() + std::chrono::seconds(1)).taken == 2);
}

TEST_CASE("firmware with another name is refused before anything is sent", "[device][faults]") {
  const Job job;
  SimTransport cable(cutter(job.machine),
                     {{.kind = SimFault::Kind::WrongName, .text = "CURIO V1.20    "}});
  const SessionEnd end = job.run(cable);
  REQUIRE(end.error);
  CHECK(end.error->kind == ErrorKind::Refused);
  CHECK(end.error->detail.find("CURIO") != std::string::npos);
  CHECK(cable.cutter().trace().settings.empty());
}

}  // namespace sim_faults_test
