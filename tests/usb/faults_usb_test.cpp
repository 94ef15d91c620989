// SPDX-License-Identifier: MIT
// The built popcutd with its real libusb, and cutters that misbehave behind an emulated bus.
#include <chrono>
#include <thread>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "tests/support/quick_tables.hpp"
#include "tests/support/running_daemon.hpp"
#include "tests/support/sim_bench.hpp"
#include "tests/support/timing.hpp"
#include "tests/support/usb_cutter.hpp"
#include "tests/support/usbfs_device.hpp"

namespace faults_usb_test {

using namespace popcut;
using namespace popcut::testing;
using namespace std::chrono_literals;
using Json = nlohmann::json;
using Kind = UsbFault::Kind;

namespace {

constexpr int kLines = 60;

SimCutter quick_cutter() {
  return value(SimCutter::make(value(find_machine("quick", {kQuickMachine}))));
}

/// The bus, and popcutd at it. Cutters are plugged in by the test.
struct Bench {
  UsbTestbed testbed;
  TempFolder folder;
  RunningDaemon popcutd;
  std::string design;

  Bench() : popcutd(0, devices()) {
    std::filesystem::create_directories(folder / "popcut");
    write_file(folder / "popcut/machines.json", kQuickMachine);
    write_file(folder / "popcut/materials.json", kQuickPaper);
    popcutd.open({"XDG_CONFIG_HOME=" + folder.path().string()});
    design = popcutd.design(RunningDaemon::lines_svg(kLines));
  }
  static std::string devices() {
    std::string text;
    for (const char* id : {"usb:51053P", "usb:1-1", "usb:1-2"})
      text += fmt::format("[[device]]\nid = \"{}\"\nmachine = \"quick\"\n", id);
    return text;
  }
  std::string ready(const std::string& device) {
    return popcutd.ready_job(design, device, {{"material", "quick-paper"}});
  }
  bool comes_to(const std::string& device, const std::string& state) {
    return happens([&] { return popcutd.device_state(device) == state; });
  }
  /// What the ledger says that is not so, once the cutter has done what it had.
  std::string wrong(const std::string& job, UsbCutter& cutter) {
    cutter.stop();
    cutter.cutter().load_media();
    cutter.cutter().run_dry();
    return wrong_in(popcutd.ledger(job), kLines, lines_of(cutter.cutter().trace(), kLines));
  }
};

const Json kKept{{"from_path", 0}, {"registration", "kept"}, {"i_accept_double_cut", true}};

}  // namespace

TEST_CASE("after any fault on the bus a job ends with a true ledger and a replug starts nothing",
          "[popcutd][usb][faults]") {
  struct Wrong {
    Kind kind;
    const char *state, *reason, *device;
    bool place_lost{false};
  };
  const auto wrong =
      GENERATE(Wrong{Kind::Unplug, "interrupted", "device_gone", "absent", true},
               Wrong{Kind::UnplugLate, "interrupted", "device_gone", "absent", true},
               Wrong{Kind::BusError, "interrupted", "device_gone", "fault", true},
               Wrong{Kind::Stall, "interrupted", "stall", "fault"},
               Wrong{Kind::MediaOut, "interrupted", "media_out", "attention", true},
               Wrong{Kind::Cancel, "interrupted", "panel_stop", "attention"},
               Wrong{Kind::StallIn, "done", "", "idle"}, Wrong{Kind::Garbage, "done", "", "idle"});
  CAPTURE(static_cast<int>(wrong.kind));
  Bench bench;
  UsbfsDevice device(bench.testbed);
  UsbCutter cutter(device, quick_cutter(), {{700, wrong.kind, 0.3, "\x1b[31m\x03<b>"}});
  device.plug();
  REQUIRE(bench.comes_to("usb:51053P", "idle"));
  const std::string id = bench.ready("usb:51053P");
  bench.popcutd.cut(id);
  const Json job = bench.popcutd.await(
      id, [](const Json& now) { return now["state"] == "done" || now["state"] == "interrupted"; });
  INFO(job.dump());
  CHECK(job["state"] == wrong.state);
  if (job["state"] == "interrupted") CHECK(job["reason"] == wrong.reason);
  CHECK(bench.comes_to("usb:51053P", wrong.device));
  CHECK(device.counts().clear_halts == (wrong.kind == Kind::Stall || wrong.kind == Kind::StallIn));
  // Plugged in again it is there, and that is all.
  const std::uint64_t before = cutter.accepted_bytes();
  if (wrong.device == std::string("absent")) {
    device.plug_again();
    CHECK(bench.comes_to("usb:51053P", "idle"));
  }
  std::this_thread::sleep_for(100ms);
  CHECK(cutter.accepted_bytes() == before);
  CHECK(bench.popcutd.job(id)["state"] == wrong.state);
  CHECK(bench.popcutd.ledger(id)["attempts"].size() == 1);
  if (job["state"] == "interrupted")
    CHECK(bench.popcutd.refused(id, "resume-from", kKept) == wrong.place_lost);
  CHECK(bench.wrong(id, cutter) == "");
}

TEST_CASE("a USB cutter that takes no data is cancelled within a second",
          "[popcutd][usb][faults][seconds]") {
  bool is_quick = false;
  // A round may meet a machine that is busy otherwise.
  for (int round = 0; round < 10 && !is_quick; ++round) {
    Bench bench;
    UsbfsDevice device(bench.testbed);
    UsbCutter cutter(device, quick_cutter(), {{900, Kind::Nak, 1e6}});
    device.plug();
    REQUIRE(bench.comes_to("usb:51053P", "idle"));
    const std::string id = bench.ready("usb:51053P");
    bench.popcutd.cut(id);
    REQUIRE(happens([&] { return cutter.accepted_bytes() >= 900; }));
    const auto begun = std::chrono::steady_clock::now();
    bench.popcutd.act(id, "cancel");
    bench.popcutd.await_state(id, "cancelled");
    is_quick = in_time(begun, 1);
    CHECK(cutter.accepted_bytes() == 900);
    CHECK(bench.wrong(id, cutter) == "");
  }
  CHECK(is_quick);
}

TEST_CASE("a job stays with its cutter when two identical ones are swapped",
          "[popcutd][usb][faults]") {
  Bench bench;
  UsbfsDevice left(bench.testbed, {.port = 1, .address = 2}),
      right(bench.testbed, {.port = 2, .address = 3});
  UsbCutter left_cutter(left, quick_cutter(), {{700, Kind::Unplug}}),
      right_cutter(right, quick_cutter());
  left.plug();
  right.plug();
  // One serial for two: they are named by their ports.
  REQUIRE(bench.comes_to("usb:1-1", "idle"));
  REQUIRE(bench.comes_to("usb:1-2", "idle"));
  CHECK(bench.popcutd.device_state("usb:51053P") != "idle");
  const std::string id = bench.ready("usb:1-1");
  bench.popcutd.cut(id);
  bench.popcutd.await_state(id, "interrupted");
  right.unplug();
  // They come back crosswise, as other devices do: under other addresses.
  UsbfsDevice swapped(bench.testbed, {.port = 1, .address = 4}),
      other(bench.testbed, {.port = 2, .address = 5});
  UsbCutter swapped_cutter(swapped, quick_cutter()), other_cutter(other, quick_cutter());
  swapped.plug();
  other.plug();
  REQUIRE(bench.comes_to("usb:1-1", "idle"));
  REQUIRE(bench.comes_to("usb:1-2", "idle"));
  CHECK(bench.popcutd.job(id)["state"] == "interrupted");
  CHECK(bench.popcutd.refused(id, "resume-from", kKept));
  CHECK(right_cutter.accepted_bytes() == 0);
  CHECK(swapped_cutter.accepted_bytes() == 0);
  CHECK(other_cutter.accepted_bytes() == 0);
  CHECK(bench.wrong(id, left_cutter) == "");
}

TEST_CASE("plugging in and out a hundred times a second starts nothing and leaks nothing",
          "[popcutd][usb][faults]") {
  Bench bench;
  UsbfsDevice device(bench.testbed);
  UsbCutter cutter(device, quick_cutter());
  device.plug();
  REQUIRE(bench.comes_to("usb:51053P", "idle"));
  const std::string id = bench.ready("usb:51053P");
  bench.popcutd.act(id, "arm", {{"sheet", 1}});
  const std::size_t files = open_files(bench.popcutd.daemon().pid());
  for (int round = 0; round < 60; ++round) {
    device.unplug();
    std::this_thread::sleep_for(5ms);
    device.plug();
    std::this_thread::sleep_for(5ms);
  }
  CHECK(bench.comes_to("usb:51053P", "idle"));
  CHECK(bench.popcutd.get("/readyz")["ready"] == true);
  // What was armed for the cutter that went is not.
  CHECK(bench.popcutd.job(id)["state"] == "ready");
  CHECK(cutter.accepted_bytes() == 0);
  // But for one or two that are there by chance.
  CHECK(happens([&] { return open_files(bench.popcutd.daemon().pid()) <= files + 2; }));
  bench.popcutd.cut(id);
  bench.popcutd.await_state(id, "done");
  CHECK(bench.wrong(id, cutter) == "");
}

TEST_CASE("a cutter that was unplugged only briefly still counts as unplugged",
          "[popcutd][usb][faults]") {
  Bench bench;
  UsbfsDevice device(bench.testbed);
  UsbCutter cutter(device, quick_cutter(), {{700, Kind::MediaOut}});
  device.plug();
  REQUIRE(bench.comes_to("usb:51053P", "idle"));
  const std::string id = bench.ready("usb:51053P");
  bench.popcutd.cut(id);
  bench.popcutd.await_state(id, "interrupted");
  // Another address at once, as after a power cycle faster than anybody looks.
  UsbfsDevice again(bench.testbed, {.address = 7});
  UsbCutter fresh(again, quick_cutter());
  device.unplug();
  again.plug();
  CHECK(bench.comes_to("usb:51053P", "idle"));
  CHECK(bench.popcutd.refused(id, "resume-from", kKept));
  CHECK(fresh.accepted_bytes() == 0);
  CHECK(bench.wrong(id, cutter) == "");
}

}  // namespace faults_usb_test
