// SPDX-License-Identifier: MIT
// Runs inside the virtual machine: the simulated cutter behind a USB gadget (FunctionFS), joined by
// dummy_hcd to the same kernel's host side, where popcut's transport finds it through real usbfs.
#include <unistd.h>

#include <array>
#include <cstdio>
#include <thread>

#include "device/session/session.hpp"
#include "device/usb/usb_bus.hpp"
#include "tests/support/ledger_checks.hpp"
#include "tests/vm/gadget.hpp"

using namespace popcut;
using namespace popcut::testing;
using namespace std::chrono_literals;

namespace {

int failures = 0;

void check(bool held, const std::string& claim, const std::string& more = "") {
  std::printf("%s: %s%s%s\n", held ? "PASS" : "FAIL", claim.c_str(), more.empty() ? "" : ": ",
              more.c_str());
  failures += held ? 0 : 1;
}

Machine quick() {
  Machine machine = *find_machine("cameo3");
  Motion& m = machine.motion;
  m.accel_mm_s2 = 1e6;
  m.travel_mm_s = 10000;
  m.drop_s = m.lift_s = 0.001;
  m.setup_s = m.trailer_s = m.autoblade_reset_s = m.autoblade_tap_s = 0.01;
  machine.speed_mm_s.per_step = 1000;
  return machine;
}

/// A hundred and fifty zigzags.
Toolpath zigzags() {
  Toolpath path;
  for (std::uint32_t k = 0; k < 150; ++k) {
    Stroke stroke;
    stroke.operation = Operation::Cut;
    stroke.first = static_cast<std::uint32_t>(path.points.size());
    stroke.count = 6;
    stroke.line = k;
    stroke.force_gf = 70;
    stroke.speed_mm_s = 5000;
    for (std::uint32_t i = 0; i < stroke.count; ++i)
      path.points.push_back({10.0 + 30 * i, 5.0 + k + 0.5 * (i % 2)});
    path.strokes.push_back(stroke);
  }
  return path;
}

std::string said(const SessionEnd& end) { return end.error ? message(*end.error) : "done"; }

std::string kernel_driver() {
  std::array<char, 256> target{};
  if (::readlink("/sys/bus/usb/devices/1-1:1.0/driver", target.data(), target.size() - 1) <= 0)
    return "none";
  const std::string path = target.data();
  return path.substr(path.rfind('/') + 1);
}

/// A fresh look at the bus: there is no udevd here to tell of changes.
std::unique_ptr<UsbTransport> connect() {
  for (int i = 0; i < 100; ++i, std::this_thread::sleep_for(50ms)) {
    const auto bus = UsbBus::open();
    if (!bus || bus->devices().empty() || kernel_driver() == "none") continue;
    auto cable = bus->connect("usb:51053P");
    if (cable) return std::move(*cable);
    std::printf("note: %s\n", message(cable.error()).c_str());
  }
  return nullptr;
}

}  // namespace

int main() {
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  const Machine machine = quick();
  Material paper = *find_material("paper-220");
  paper.blade_offset_mm = 0;
  const Toolpath path = zigzags();
  const EncodedProgram program = *encode(path, machine, paper, {});
  const MeantLines meant(path, machine.unit_mm);
  SessionOptions options;
  options.window_s = 0.5;
  options.poll_s = 0.05;
  const auto cutter = [&] { return *SimCutter::make(machine); };
  Gadget gadget(cutter());
  check(gadget.lawful(), "the gadget's descriptors are lawful");
  const auto lines = [&](bool all = false) {
    return gadget.with_cutter([&](SimCutter& sim) {
      if (all) sim.run_dry();
      return cut_lines(sim.trace(), meant);
    });
  };
  Gadget::plug(true);

  // 1. A whole sheet.
  auto cable = connect();
  check(cable != nullptr, "the cutter is found and claimed through the kernel's usbfs");
  if (cable == nullptr) return 1;
  check(cable->displaced_driver() == "usblp", "usblp had it and let go", cable->displaced_driver());
  const UsbInterface& interface = cable->device().interface;
  check(interface.printer && interface.out_endpoint != 0 && (interface.in_endpoint & 0x80) != 0,
        "its endpoints are those of its descriptors");
  check(UsbBus::open()->connect("usb:51053P").error().detail.find("another program") == 0,
        "a second opener is refused");
  SessionEnd end = run_session(*cable, machine, program, options);
  check(!end.error && end.confirmed, "a whole sheet is streamed", said(end));
  std::string wrong = untrue(end, lines(), lines(true), meant);
  check(wrong.empty() && lines().whole == meant.lines.size(), "the cutter drew every line once",
        wrong);
  cable.reset();
  for (int i = 0; i < 40 && kernel_driver() != "usblp"; ++i) std::this_thread::sleep_for(50ms);
  check(kernel_driver() == "usblp", "usblp has it back", kernel_driver());

  // 2. Unplugged in the middle, then plugged in again.
  gadget.fresh(cutter());
  cable = connect();
  std::thread hand([&] {
    for (int i = 0; i < 2000 && lines().begun < 40; ++i) std::this_thread::sleep_for(1ms);
    Gadget::plug(false);
  });
  end = run_session(*cable, machine, program, options);
  hand.join();
  check(end.error && end.error->kind == ErrorKind::DeviceGone, "unplugging ends the sheet",
        said(end));
  wrong = untrue(end, lines(), lines(true), meant);
  check(wrong.empty(), "the ledger is true", wrong);
  cable.reset();
  gadget.fresh(cutter());
  Gadget::plug(true);
  cable = connect();
  check(cable != nullptr && lines(true).begun == 0, "plugged in again it is sent nothing");
  end = run_session(*cable, machine, program, options);
  check(!end.error, "and cuts the next sheet", said(end));

  // 3. A cutter that takes no more: the count of a timeout is exact.
  gadget.deaf_after(0);
  std::this_thread::sleep_for(20ms);
  const std::string ahead(8192, '\x03');
  const auto write = cable->write(std::as_bytes(std::span(ahead)), cable->now() + 500ms);
  check(write.error && write.error->kind == ErrorKind::Timeout && write.taken <= 512,
        "a deaf cutter is a timeout with an exact count", std::to_string(write.taken));
  std::printf("%s\n", failures == 0 ? "ALL PASSED" : "SOME FAILED");
  std::fflush(stdout);
  std::_Exit(failures == 0 ? 0 : 1);
}
