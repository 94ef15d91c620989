// SPDX-License-Identifier: MIT
// Whole sessions with the simulated cutter behind an emulated USB device, in real time. The cutter
// moves two hundred times as fast as a real one; every time of the host is what it is.
#include <chrono>
#include <cstdlib>
#include <future>
#include <optional>
#include <thread>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "device/session/session.hpp"
#include "device/usb/usb_bus.hpp"
#include "tests/support/ledger_checks.hpp"
#include "tests/support/rounds.hpp"
#include "tests/support/sim_bench.hpp"
#include "tests/support/usb_cutter.hpp"
#include "tests/support/usbfs_device.hpp"

namespace usb_session_test {

using namespace popcut;
using namespace popcut::testing;
using namespace std::chrono_literals;

namespace {

using Kind = UsbFault::Kind;

constexpr double kFaster = 200;

/// The same machine, `factor` times as fast in all it does.
Machine sped_up(Machine machine, double factor) {
  Motion& m = machine.motion;
  m.accel_mm_s2 *= factor * factor;
  m.travel_mm_s *= factor;
  machine.speed_mm_s.per_step *= factor;
  for (double* seconds :
       {&m.drop_s, &m.lift_s, &m.setup_s, &m.trailer_s, &m.autoblade_reset_s, &m.autoblade_tap_s})
    *seconds /= factor;
  return machine;
}

/// A job of random strokes.
struct Job {
  Machine target;
  Toolpath path;
  EncodedProgram program;
  MeantLines meant;

  static Job make(std::uint32_t seed, std::size_t strokes, std::uint32_t buffer_bytes = 65536) {
    std::mt19937 random(seed);
    Machine target = sped_up(machine("cameo3"), kFaster);
    target.buffer_bytes = buffer_bytes;
    const Material paper = value(find_material("paper-220"));
    Material fast = paper;
    for (ToolSettings* tool : {&fast.cut, &fast.fold, &fast.draw}) tool->speed_mm_s *= kFaster;
    fast.blade_offset_mm = 0;  // swivelling it at corners takes its time at any speed
    Toolpath path = random_toolpath(random, strokes, 90, fast);
    JobOptions options;
    options.page_length_mm = 300;
    EncodedProgram program = value(encode(path, target, fast, options));
    MeantLines meant(path, target.unit_mm);
    return {std::move(target), std::move(path), std::move(program), std::move(meant)};
  }
  /// A byte of the geometry, as a part of it.
  [[nodiscard]] std::uint64_t byte(double part) const {
    const double length = static_cast<double>(program.geometry.end - program.geometry.begin);
    return program.geometry.begin + static_cast<std::uint64_t>(part * length);
  }
};

/// Where all goes well, or what goes wrong says so: the machine that plays the cutter may be busy
/// with other things for a while.
SessionOptions patient() {
  SessionOptions options;
  options.window_s = 0.6;
  options.poll_s = 0.05;
  options.reply_s = 5;
  options.stuck_s = 60;
  options.pause_limit_s = 60;
  return options;
}

SessionOptions impatient() {
  SessionOptions options;
  options.window_s = 0.6;
  options.poll_s = 0.05;
  options.reply_s = 0.4;
  options.stuck_s = 2;
  options.pause_limit_s = 2;
  return options;
}

SimCutter cutter_for(const Job& job) {
  SimOptions sheet;
  sheet.page_length_mm = 300;
  return value(SimCutter::make(job.target, sheet));
}

/// One session, from connecting to letting go, and what the cutter did.
struct Ended {
  SessionEnd end;
  CutLines now, later;
  std::uint64_t accepted{};
  std::string why;  ///< what the ledger says that is not so
};

Ended session(const UsbBus& usb, UsbfsDevice& device, const std::string& id, const Job& job,
              UsbCutter& cutter, const SessionOptions& options) {
  Ended ended;
  {
    auto cable = usb.connect(id);
    if (!cable) {
      ended.why = message(cable.error());
      return ended;
    }
    ended.end = run_session(**cable, job.target, job.program, options);
  }
  // A cutter that is plugged in again is sent nothing by anybody.
  const std::uint64_t before = cutter.accepted_bytes();
  device.plug_again();
  std::this_thread::sleep_for(20ms);
  cutter.stop();
  ended.accepted = cutter.cutter().accepted_bytes();
  ended.now = cut_lines(cutter.cutter().trace(), job.meant);
  cutter.cutter().load_media();
  cutter.cutter().resume();
  cutter.cutter().run_dry();
  ended.later = cut_lines(cutter.cutter().trace(), job.meant);
  ended.why = ended.accepted != before ? "bytes were sent after the end"
                                       : untrue(ended.end, ended.now, ended.later, job.meant);
  return ended;
}

Ended run(const Job& job, std::vector<UsbFault> faults, const SessionOptions& options = patient()) {
  UsbTestbed testbed;
  UsbfsDevice device(testbed);
  UsbCutter cutter(device, cutter_for(job), std::move(faults));
  device.plug();
  const UsbBus usb = value(UsbBus::open());
  return session(usb, device, "usb:51053P", job, cutter, options);
}

std::string said(const SessionEnd& end) { return end.error ? message(*end.error) : "done"; }

void check_failed(const Ended& ended, ErrorKind kind, const std::string& telling) {
  INFO(said(ended.end));
  CHECK(ended.why == "");
  REQUIRE(ended.end.error);
  CHECK(ended.end.error->kind == kind);
  CHECK(ended.end.error->detail.find(telling) != std::string::npos);
  CHECK_FALSE(ended.end.confirmed);
}

}  // namespace

TEST_CASE("a whole sheet goes through libusb and the cutter draws every line of it once",
          "[device][usb][session]") {
  const Job job = Job::make(1, 300);
  const Ended ended = run(job, {});
  INFO(said(ended.end));
  REQUIRE_FALSE(ended.end.error);
  CHECK(ended.why == "");
  CHECK(ended.end.confirmed);
  CHECK(ended.end.identity == "CAMEO 3 V1.60    ");
  CHECK(ended.now.whole == job.meant.lines.size());
  CHECK(count(ended.end, StrokeFate::Certain) == job.meant.lines.size());
}

TEST_CASE("a cutter with a small buffer is fed as it drains", "[device][usb][session]") {
  const Job job = Job::make(2, 150, 400);
  const Ended ended = run(job, {{job.byte(0.3), Kind::Nak, 0.5}, {job.byte(0.6), Kind::Nak, 0.2}});
  INFO(said(ended.end));
  REQUIRE_FALSE(ended.end.error);
  CHECK(ended.why == "");
  CHECK(ended.now.whole == job.meant.lines.size());
}

TEST_CASE("a stall in the middle of a sheet ends it with the rest not sent",
          "[device][usb][session]") {
  const Job job = Job::make(3, 100);
  const Ended ended = run(job, {{job.byte(0.5), Kind::Stall}});
  check_failed(ended, ErrorKind::Refused, "stalled");
  CHECK(ended.accepted == job.byte(0.5) + 0);
  CHECK(count(ended.end, StrokeFate::NotSent) > 20);
  CHECK(ended.later.begun < job.meant.lines.size());
}

TEST_CASE("a cutter unplugged in the middle of a transfer leaves a true ledger",
          "[device][usb][session]") {
  for (const Kind how : {Kind::Unplug, Kind::UnplugLate}) {
    const Job job = Job::make(4, 100);
    const Ended ended = run(job, {{job.byte(0.5) + 3, how}});
    // The word of the hub may come too late for the second on a busy machine.
    check_failed(ended, ErrorKind::DeviceGone, how == Kind::Unplug ? "unplugged" : "");
    CHECK(count(ended.end, StrokeFate::InDoubt) > 0);
    CHECK(count(ended.end, StrokeFate::NotSent) > 0);
  }
}

TEST_CASE("a cutter that stops taking data ends the session and nothing is sent again",
          "[device][usb][session]") {
  const Job job = Job::make(5, 100);
  const Ended ended = run(job, {{job.byte(0.4), Kind::Nak, 1000}}, impatient());
  check_failed(ended, ErrorKind::Timeout, "taken no data");
  CHECK(count(ended.end, StrokeFate::NotSent) > 0);
}

TEST_CASE("a failed transfer on the bus ends the session and reports what is in doubt",
          "[device][usb][session]") {
  const Job job = Job::make(6, 100);
  const Ended ended = run(job, {{job.byte(0.4), Kind::BusError}});
  check_failed(ended, ErrorKind::DeviceGone, "failed on the bus");
  CHECK(count(ended.end, StrokeFate::InDoubt) > 0);
}

TEST_CASE("a pause or cancel on the panel is noticed over USB", "[device][usb][session]") {
  const Job job = Job::make(7, 100);
  const Ended paused = run(job, {{job.byte(0.3), Kind::Pause, 0.5}});
  INFO(said(paused.end));
  CHECK_FALSE(paused.end.error);
  CHECK(paused.why == "");
  check_failed(run(job, {{job.byte(0.3), Kind::Cancel, 0.3}}), ErrorKind::Refused,
               "cancelled on the machine's panel");
  check_failed(run(job, {{job.byte(0.3), Kind::MediaOut}}), ErrorKind::Refused, "sheet came out");
}

TEST_CASE("another program cannot open the cutter in the middle of a sheet",
          "[device][usb][session]") {
  const Job job = Job::make(8, 200);
  UsbTestbed testbed;
  UsbfsDevice device(testbed);
  UsbCutter cutter(device, cutter_for(job));
  device.plug();
  const UsbBus usb = value(UsbBus::open());
  std::vector<std::string> refusals;
  SessionOptions options = patient();
  options.progress = [&](const SessionProgress& p) {
    if (p.phase != SessionPhase::Cutting || refusals.size() >= 5) return;
    const auto second = usb.connect("usb:51053P");
    refusals.push_back(second ? "it got it" : message(second.error()));
  };
  const Ended ended = session(usb, device, "usb:51053P", job, cutter, options);
  INFO(said(ended.end));
  CHECK_FALSE(ended.end.error);
  CHECK(ended.why == "");
  REQUIRE(refusals.size() == 5);
  for (const std::string& refusal : refusals)
    CHECK(refusal.find("another program uses the cutter") != std::string::npos);
}

namespace {

/// One or two faults of any kind at any byte.
std::vector<UsbFault> random_faults(std::mt19937& random, std::uint64_t program_bytes) {
  const std::string texts[] = {"0\x03", "1\x03", "x", std::string(300, ' '), "4", "\x03\x03"};
  const double waits[] = {0.01, 0.1, 0.3, 1.5};
  const auto any = [&](int most) { return std::uniform_int_distribution<int>(0, most)(random); };
  std::vector<UsbFault> faults(static_cast<std::size_t>(1 + any(1)));
  for (UsbFault& fault : faults) {
    fault.kind = static_cast<Kind>(any(static_cast<int>(Kind::MediaOut)));
    fault.at_byte = std::uniform_int_distribution<std::uint64_t>(0, program_bytes)(random);
    fault.seconds = waits[any(3)];
    fault.text = texts[any(5)];
  }
  return faults;
}

struct Script {
  std::uint32_t seed{};
  Job job;
  std::vector<UsbFault> faults;
  SessionOptions options = impatient();
  std::atomic<bool> cancel{false};
  SimCutter cutter;
  Ended ended;

  explicit Script(std::uint32_t s)
      : seed(s), job(Job::make(s, 60, s % 2 == 0 ? 500 : 65536)), cutter(cutter_for(job)) {
    std::mt19937 random(s + 77);
    faults = random_faults(random, job.program.bytes.size());
    if (s % 5 != 0) return;  // a host that gives up somewhere on the way
    options.cancel = &cancel;
    const std::size_t at = std::uniform_int_distribution<std::size_t>(0, 60)(random);
    options.progress = [this, at](const SessionProgress& p) {
      if (p.strokes_done >= at) cancel = true;
    };
  }
  [[nodiscard]] std::string told() const {
    std::string what = fmt::format("seed {}:", seed);
    for (const UsbFault& fault : faults)
      what += fmt::format(" fault {} at byte {} for {} s;", static_cast<int>(fault.kind),
                          fault.at_byte, fault.seconds);
    return what + " " + said(ended.end);
  }
};

/// Plays a script on a device of its own. Catch is not to be called here: many play at once.
void play(const UsbTestbed& testbed, const UsbBus& usb, Script& script, int place) {
  const std::string serial = fmt::format("S{}", place);
  UsbfsDevice device(testbed, {.serial = serial, .port = place, .address = place + 1});
  UsbCutter cutter(device, std::move(script.cutter), script.faults);
  device.plug();
  const std::string id = "usb:" + serial;
  // By the clock: the others' coming and going are changes too.
  const auto until = std::chrono::steady_clock::now() + 60s;
  while (std::chrono::steady_clock::now() < until) {
    const std::uint64_t seen = usb.changes();
    const auto devices = usb.devices();
    if (std::any_of(devices.begin(), devices.end(), [&](const auto& d) { return d.id == id; }))
      break;
    static_cast<void>(usb.wait_for_change(seen, 50ms));
  }
  script.ended = session(usb, device, id, script.job, cutter, script.options);
}

}  // namespace

// ./run soak usb plays a thousand of them.
TEST_CASE("after any fault on the bus the ledger is true and nothing is cut twice",
          "[device][usb][session][scripts]") {
  const char* const wanted = std::getenv("POPCUT_USB_SCRIPTS");
  const int scripts = wanted == nullptr ? testing::rounds(24, 3) : std::atoi(wanted);
  constexpr int kAtOnce = 8;
  int done = 0, failed = 0;
  UsbTestbed testbed;
  const UsbBus usb = value(UsbBus::open());
  for (int first = 0; first < scripts; first += kAtOnce) {
    std::vector<std::unique_ptr<Script>> batch;
    std::vector<std::future<void>> played;
    for (int i = first; i < std::min(first + kAtOnce, scripts); ++i)
      batch.push_back(std::make_unique<Script>(static_cast<std::uint32_t>(i)));
    for (std::size_t i = 0; i < batch.size(); ++i)
      played.push_back(std::async(
          std::launch::async, [&, i] { play(testbed, usb, *batch[i], static_cast<int>(i) + 1); }));
    for (std::future<void>& one : played) one.get();
    for (const std::unique_ptr<Script>& script : batch) {
      INFO(script->told());
      CHECK(script->ended.why == "");
      REQUIRE(script->ended.end.fates.size() == script->job.path.strokes.size());
      ++(script->ended.end.error ? failed : done);
    }
  }
  WARN(fmt::format("{} scripts: {} sheets done, {} given up", scripts, done, failed));
  CHECK(failed > 0);
  CHECK(done > 0);
}

}  // namespace usb_session_test
