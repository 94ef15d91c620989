// SPDX-License-Identifier: MIT
// The built popcut with its real libusb, at a terminal, with an emulated cutter plugged in.
#include <chrono>
#include <csignal>
#include <thread>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "core/formats/svg/svg_reader.hpp"
#include "device/compare/expect.hpp"
#include "tests/support/at_terminal.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/process.hpp"
#include "tests/support/quick_tables.hpp"
#include "tests/support/sim_bench.hpp"
#include "tests/support/usb_cutter.hpp"
#include "tests/support/usbfs_device.hpp"

namespace usb_command_test {

using namespace popcut;
using namespace popcut::testing;
using namespace std::chrono_literals;

namespace {

const std::string kSphere = source_file("examples/sphere.json");

/// A folder with the quick tables, a bus, and a cutter on it.
struct Workshop {
  TempFolder folder;
  UsbTestbed testbed;
  UsbfsDevice device;
  UsbCutter cutter;

  explicit Workshop(std::vector<UsbFault> faults = {}, const SimOptions& around = {},
                    UsbfsShape shape = {}, const char* identity = nullptr)
      : device(testbed, std::move(shape)),
        cutter(device, make(around, identity), std::move(faults)) {
    std::filesystem::create_directories(folder / "config/popcut");
    write_file(folder / "config/popcut/machines.json", kQuickMachine);
    write_file(folder / "config/popcut/materials.json", kQuickPaper);
    device.plug();
  }
  static SimCutter make(const SimOptions& around, const char* identity) {
    Machine machine = value(find_machine("quick", {kQuickMachine}));
    if (identity != nullptr) machine.identity = identity;
    return value(SimCutter::make(machine, around));
  }
  [[nodiscard]] std::vector<std::string> cut_words() const {
    // Without overcut the trace is the sheet's drawing, stroke by stroke.
    return {"cut",        kSphere,       "--direct", "--device", "usb:51053P", "--machine", "quick",
            "--material", "quick-paper", "-o",       "cut",      "--overcut",  "0"};
  }
  struct Said {
    int exit{};
    std::string out, shown;
  };
  Said run(const std::vector<std::string>& words) {
    AtTerminal popcut(popcut_program(), words, folder);
    const int exit = popcut.ended();
    return {exit, popcut.out(), popcut.shown};
  }
  Said doctor() { return run({"doctor"}); }
};

}  // namespace

TEST_CASE("after a person confirms the whole sheet is cut over USB as planned", "[cli][usb][e2e]") {
  Workshop shop;
  AtTerminal popcut(popcut_program(), shop.cut_words(), shop.folder);
  const bool asked = popcut.shows("Start cutting? [y/N]");
  INFO(popcut.shown);
  REQUIRE(asked);
  std::this_thread::sleep_for(50ms);
  CHECK(shop.cutter.accepted_bytes() == 0);  // nothing is sent before the yes
  CHECK(shop.device.driver() == "usblp");
  popcut.type("y\n");
  const int exit = popcut.ended();
  INFO(popcut.shown);
  REQUIRE(exit == 0);
  CHECK(says(popcut.shown, "0 in doubt, 0 not sent, on usb:51053P"));
  CHECK(shop.device.driver() == "usblp");  // given back
  shop.cutter.stop();
  const Trace& trace = shop.cutter.cutter().trace();
  CHECK(trace.unknown.empty());
  CHECK(trace.strokes.size() > 100);
  Expected expected;
  expected.drawing =
      value(linework_from_svg(text_of_file(shop.folder / "cut/sheet-01.svg"), SvgProfile::Popcut));
  const auto held = expect(trace, expected);
  INFO((held ? std::string("as planned") : message(held.error())));
  CHECK(held);
}

TEST_CASE("without a person's confirmation nothing is sent", "[cli][usb][e2e]") {
  Workshop shop;
  AtTerminal popcut(popcut_program(), shop.cut_words(), shop.folder);
  REQUIRE(popcut.shows("Start cutting? [y/N]"));
  popcut.type("no\n");
  CHECK(popcut.ended() == 5);
  CHECK(shop.cutter.accepted_bytes() == 0);
  CHECK(shop.device.counts().detaches == 0);
  // And --yes is no way around it.
  std::vector<std::string> words = shop.cut_words();
  words.push_back("--yes");
  const auto said = shop.run(words);
  CHECK(said.exit == 2);
  CHECK(says(said.shown, "you are asked before each sheet"));
  CHECK(shop.cutter.accepted_bytes() == 0);
}

TEST_CASE("a cable pulled in mid-sheet is reported with what is cut and what is in doubt",
          "[cli][usb][e2e]") {
  Workshop shop({{3000, UsbFault::Kind::Unplug}});
  AtTerminal popcut(popcut_program(), shop.cut_words(), shop.folder);
  REQUIRE(popcut.shows("Start cutting? [y/N]"));
  popcut.type("y\n");
  const int exit = popcut.ended();
  INFO(popcut.shown);
  CHECK(exit == 5);
  CHECK(says(popcut.shown, "usb:51053P"));
  CHECK(says(popcut.shown, "unplugged"));
  CHECK(says(popcut.shown, "in doubt"));
  CHECK(says(popcut.shown, "not sent"));
}

TEST_CASE("SIGTERM, SIGHUP and a closed terminal end a cut as Ctrl-C does", "[cli][usb][e2e]") {
  for (const std::string how : {"ctrl-c", "SIGTERM", "SIGHUP", "closed"}) {
    CAPTURE(how);
    Workshop shop;
    AtTerminal popcut(popcut_program(), shop.cut_words(), shop.folder);
    REQUIRE(popcut.shows("Start cutting? [y/N]"));
    popcut.type("y\n");
    while (shop.cutter.strokes() < 20) std::this_thread::sleep_for(1ms);
    if (how == "ctrl-c") popcut.type("\x03");
    if (how == "SIGTERM") popcut.signal(SIGTERM);
    if (how == "SIGHUP") popcut.signal(SIGHUP);
    if (how == "closed") popcut.close();
    const int exit = popcut.ended();
    INFO(popcut.shown);
    CHECK(exit == 5);
    if (how != "closed")
      CHECK(says(popcut.shown, "stopped as you asked, with the tool up and parked"));
    CHECK(shop.device.driver() == "usblp");  // given back
    shop.cutter.stop();
    SimCutter& cutter = shop.cutter.cutter();
    cutter.run_dry();
    CHECK_FALSE(cutter.tool_down());
    CHECK(cutter.position() == PagePoint{0, 0});
    CHECK(cutter.trace().unknown.empty());
    CHECK(cutter.trace().strokes.size() < 378);  // of 378
  }
}

TEST_CASE("devices lists what is plugged in with its name and its state", "[cli][usb][e2e]") {
  Workshop shop;
  const auto said = shop.run({"devices"});
  CHECK(said.exit == 0);
  CHECK(says(said.out, "usb:51053P"));
  CHECK(says(said.out, "Silhouette Cameo 3\n"));
  const auto json = nlohmann::json::parse(shop.run({"devices", "--json"}).out);
  const auto first = json["devices"][0];
  CHECK(first["id"] == "usb:51053P");
  CHECK(first["machine"] == "cameo3");
  CHECK(first["state"] == "free");
  CHECK(first["driver"] == "usblp");
  CHECK(first["simulated"] == false);
  CHECK(shop.device.counts().detaches == 0);
  CHECK(shop.cutter.accepted_bytes() == 0);
}

TEST_CASE("doctor finds a cutter that is ready and says so", "[cli][usb][doctor][e2e]") {
  Workshop shop;
  const auto said = shop.doctor();
  INFO(said.out + said.shown);
  CHECK(said.exit == 0);
  CHECK(says(said.out, "is a Silhouette Cameo 3"));
  CHECK(says(said.out, "the kernel driver usblp holds it"));
  CHECK(says(said.out, "ready; look whether a sheet is loaded"));
  CHECK(says(said.out, "calls itself CAMEO 3, firmware V1.60"));
  CHECK_FALSE(says(said.out, "PROBLEM"));
  CHECK(shop.device.driver() == "usblp");
  const auto json = nlohmann::json::parse(shop.run({"doctor", "--json"}).out);
  CHECK(json["usable"] == true);
}

TEST_CASE("doctor says to load an empty cutter", "[cli][usb][doctor][e2e]") {
  SimOptions empty;
  empty.media = false;
  Workshop shop({}, empty);
  const auto said = shop.doctor();
  INFO(said.out + said.shown);
  CHECK(said.exit == 5);
  CHECK(says(said.out, "PROBLEM  no sheet is loaded"));
  CHECK(says(said.out, "press load"));
  CHECK(says(said.shown, "popcut: usb:51053P: no sheet is loaded; "));
}

TEST_CASE("doctor notes untested firmware and refuses another model", "[cli][usb][doctor][e2e]") {
  {
    Workshop shop({}, {}, {}, "CAMEO 3 V9.99    ");
    const auto said = shop.doctor();
    INFO(said.out);
    CHECK(said.exit == 0);
    CHECK(says(said.out, "firmware V9.99; popcut was tested with recordings of V1.60"));
  }
  Workshop shop({}, {}, {}, "CAMEO 9 V1.00    ");
  const auto said = shop.doctor();
  INFO(said.out);
  CHECK(said.exit == 5);
  CHECK(says(said.out, "calls itself CAMEO 9"));
  CHECK(says(said.out, "--treat-as"));
}

TEST_CASE("doctor and cut explain --treat-as for an unknown model", "[cli][usb][doctor][e2e]") {
  Workshop shop({}, {}, {.product = 0x1199, .name = "CAMEO 7"});
  const auto said = shop.doctor();
  INFO(said.out);
  CHECK(said.exit == 5);
  CHECK(says(said.out, "the model \"CAMEO 7\" (0b4d:1199) is not known"));
  CHECK(says(said.out, "popcut doctor usb:51053P --treat-as"));
  CHECK(shop.cutter.accepted_bytes() == 0);  // it was asked nothing
  const auto refused = shop.run(shop.cut_words());
  CHECK(refused.exit == 5);
  CHECK(says(refused.shown, "--treat-as"));
  const auto treated = shop.run({"doctor", "usb:51053P", "--treat-as", "cameo3"});
  INFO(treated.out);
  CHECK(treated.exit == 0);
  CHECK(says(treated.out, "treated as a Silhouette Cameo 3 because of --treat-as"));
  const auto list = shop.run({"devices"});
  CHECK(says(list.out, "unknown model (CAMEO 7, 0b4d:1199)"));
  // With the name of a known one it is cut on.
  std::vector<std::string> words = shop.cut_words();
  words[5] = "--treat-as";
  AtTerminal popcut(popcut_program(), words, shop.folder);
  REQUIRE(popcut.shows("Start cutting? [y/N]"));
  popcut.type("y\n");
  CHECK(popcut.ended() == 0);
}

TEST_CASE("doctor names the program that uses the cutter", "[cli][usb][doctor][e2e]") {
  Workshop shop({{900, UsbFault::Kind::Nak, 1e6}});  // it cuts until the test lets it go on
  AtTerminal other(popcut_program(), shop.cut_words(), shop.folder);
  REQUIRE(other.shows("Start cutting? [y/N]"));
  other.type("y\n");
  for (int i = 0; i < 60'000 && shop.cutter.accepted_bytes() < 900; ++i)
    std::this_thread::sleep_for(1ms);
  REQUIRE(shop.device.driver().empty());
  const auto said = shop.doctor();
  INFO(said.out + said.shown);
  CHECK(said.exit == 5);
  CHECK(says(said.out, "uses it"));
  const auto second = shop.run(shop.cut_words());
  CHECK(second.exit == 5);
  CHECK(says(second.shown, "another program uses the cutter"));
  shop.cutter.take_again();
  CHECK(other.ended() == 0);
}

TEST_CASE("doctor explains a missing permission step by step", "[cli][usb][doctor][e2e]") {
  if (::geteuid() != 0) {
    WARN("skipped: only root can play a user without permission");
    return;
  }
  Workshop shop;
  // A program that starts as root and becomes nobody: the node is root's alone.
  const std::vector<std::string> nobody{"/usr/bin/setpriv", "--reuid=65534", "--regid=65534",
                                        "--clear-groups", popcut_program()};
  if (!std::filesystem::exists(nobody.front())) {
    WARN("skipped: no setpriv");
    return;
  }
  std::vector<std::string> words = nobody;
  words.push_back("doctor");
  const Ran doctor = run_program(words, "/");
  if (doctor.exit == 127 || says(doctor.err, "Permission denied")) {
    WARN("skipped: another user may not start the built popcut");
    return;
  }
  INFO(doctor.out + doctor.err);
  CHECK(doctor.exit == 5);
  CHECK(says(doctor.out, "PROBLEM  nobody may not open /dev/bus/usb/001/002"));
  CHECK(says(doctor.out, "sudo usermod -aG popcut-usb nobody"));
  CHECK(says(doctor.out, "popcut doctor --udev-rule | sudo tee"));
  CHECK(says(doctor.out, "log out and in again"));
  words.back() = "devices";
  CHECK(says(run_program(words, "/").out, "no permission"));
}

TEST_CASE("doctor helps where nothing is plugged in", "[cli][usb][doctor][e2e]") {
  Workshop shop;
  shop.device.unplug();
  const auto said = shop.doctor();
  CHECK(said.exit == 5);
  CHECK(says(said.out, "no cutter is plugged in"));
  CHECK(says(said.out, "another cable"));
  const auto gone = shop.run(shop.cut_words());
  CHECK(gone.exit == 5);
  CHECK(says(gone.shown, "no such device is plugged in"));
}

TEST_CASE("doctor does not mistake an office printer for a cutter", "[cli][usb][doctor][e2e]") {
  Workshop shop({}, {}, {.vendor = 0x03f0, .product = 0x0001, .name = "LaserJet"});
  const auto said = shop.doctor();
  INFO(said.out);
  CHECK(said.exit == 5);
  CHECK(says(said.out, "\"LaserJet\" (03f0:0001) is not known as a cutter; it may be a printer"));
  CHECK(shop.cutter.accepted_bytes() == 0);
  CHECK(shop.device.counts().detaches == 0);
}

TEST_CASE("the udev rule that ships names every vendor of the table", "[cli][usb][doctor][e2e]") {
  Workshop shop;
  const std::string rule = shop.run({"doctor", "--udev-rule"}).out;
  CHECK(rule == text_of_file(source_file("systemd/60-popcut.rules")));
  for (const Machine& machine : value(all_machines()))
    if (machine.usb_vendor != 0)
      CHECK(says(rule, fmt::format("ATTR{{idVendor}}==\"{:04x}\"", machine.usb_vendor)));
}

}  // namespace usb_command_test
