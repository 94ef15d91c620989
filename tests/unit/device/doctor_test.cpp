// SPDX-License-Identifier: MIT
#include <catch2/catch.hpp>

#include "device/doctor.hpp"
#include "tests/support/process.hpp"
#include "tests/support/sim_bench.hpp"

namespace doctor_test {

using namespace popcut;
using namespace popcut::testing;

namespace {

CutterFacts cameo3() {
  CutterFacts facts;
  facts.device.id = "usb:51053P";
  facts.device.port = "1-1";
  facts.device.node = "/dev/bus/usb/001/002";
  facts.device.vendor_id = 0x0b4d;
  facts.device.product_id = 0x112f;
  facts.device.product = "CAMEO 3";
  facts.device.interface.printer = true;
  facts.machine = machine("cameo3");
  facts.use = {UsbState::Free, "usblp"};
  facts.said = Answers{DeviceStatus::Ready, "CAMEO 3 V1.60    "};
  return facts;
}

Surroundings member() { return {"anna", true, true, true, true}; }

/// All findings as one text.
std::string told(const CutterFacts& facts, const Surroundings& around = member()) {
  std::string text;
  for (const Finding& finding : diagnose(facts, around)) {
    // Every problem comes with what to do.
    if (finding.level == Finding::Level::Problem) CHECK_FALSE(finding.remedy.empty());
    text += fmt::format("{}: {} -> {}\n", name_of(finding.level), finding.what, finding.remedy);
  }
  return text;
}

}  // namespace

TEST_CASE("a healthy cutter has no problems", "[device][doctor]") {
  CHECK_FALSE(says(told(cameo3()), "problem"));
}

TEST_CASE("each status of the machine has its own advice", "[device][doctor]") {
  const std::pair<std::optional<DeviceStatus>, const char*> cases[] = {
      {DeviceStatus::NoMedia, "problem: no sheet is loaded"},
      {DeviceStatus::Paused, "problem: paused on its panel"},
      {DeviceStatus::Cancelled, "problem: the last job was cancelled"},
      {DeviceStatus::Moving, "note: busy"},
      {DeviceStatus::Unknown, "problem: its status cannot be read"},
      {std::nullopt, "problem: it takes no data"},
  };
  for (const auto& [status, words] : cases) {
    CutterFacts facts = cameo3();
    facts.said = Answers{status, "CAMEO 3 V1.60    "};
    CAPTURE(words);
    CHECK(says(told(facts), words));
  }
}

TEST_CASE("a cutter that does not answer shows the error and its remedy apart",
          "[device][doctor]") {
  CutterFacts facts = cameo3();
  facts.said = fail(ErrorKind::Timeout, "", "the machine did not answer; check its cable");
  CHECK(says(told(facts), "problem: the machine did not answer -> check its cable"));
}

TEST_CASE("CUPS holding the printer port is named with the remedy", "[device][doctor]") {
  CutterFacts facts = cameo3();
  facts.said.reset();
  facts.holders = {"usb (812)"};
  const std::string text = told(facts);
  CHECK(says(text, "problem: usb (812) has its printer port open; CUPS uses it as a printer"));
  CHECK(says(text, "lpadmin -x"));
}

TEST_CASE("a missing permission is explained by the missing steps", "[device][doctor]") {
  CutterFacts facts = cameo3();
  facts.said.reset();
  facts.use.state = UsbState::NoPermission;
  const std::string fresh = told(facts, {"anna", false, false, false, false});
  CHECK(says(fresh, "anna may not open /dev/bus/usb/001/002"));
  CHECK(says(fresh, "1. sudo groupadd --system popcut-usb"));
  CHECK(says(fresh, "2. popcut doctor --udev-rule | sudo tee /etc/udev/rules.d/60-popcut.rules"));
  CHECK(says(fresh, "3. sudo usermod -aG popcut-usb anna"));
  CHECK(says(fresh, "4. sudo udevadm control --reload"));
  CHECK(says(fresh, "5. log out and in again"));
  const std::string nearly = told(facts, {"anna", true, true, true, false});
  CHECK(says(nearly, "-> 1. log out and in again\n"));
  CHECK_FALSE(says(nearly, "usermod"));
  CHECK(says(told(facts), "plug the cutter in again"));
}

TEST_CASE("unknown firmware and unknown models are distinguished", "[device][doctor]") {
  CutterFacts facts = cameo3();
  facts.said = Answers{DeviceStatus::Ready, "CAMEO 3 V1.99    "};
  CHECK(says(told(facts),
             "note: calls itself CAMEO 3, firmware V1.99; popcut was tested with "
             "recordings of V1.60"));
  facts.said = Answers{DeviceStatus::Ready, "CAMEO 9 V1.00    "};
  CHECK(says(told(facts), "problem: calls itself CAMEO 9, firmware V1.00, although"));
  facts.treated = true;
  CHECK_FALSE(says(told(facts), "problem"));
  facts = cameo3();
  facts.machine = machine("cameo4");  // whose identity was never recorded
  facts.said = Answers{DeviceStatus::Ready, "CAMEO 4 V1.30    "};
  CHECK(says(told(facts),
             "note: calls itself CAMEO 4, firmware V1.30; popcut has not been tested with"));
  facts.said = Answers{DeviceStatus::Ready, "\x01\x02"};
  CHECK(says(told(facts), "problem: it does not say what it is"));
}

TEST_CASE("a busy or empty machine that does not send its name is not a problem",
          "[device][doctor]") {
  CutterFacts facts = cameo3();
  facts.said = Answers{DeviceStatus::NoMedia, ""};
  CHECK_FALSE(says(told(facts), "what it is"));
  facts.said = Answers{DeviceStatus::Ready, ""};
  CHECK(says(told(facts), "problem: it does not say what it is"));
}

TEST_CASE("an empty bus gets advice and ports that may hold a vinyl cutter", "[device][doctor]") {
  CHECK_FALSE(says(nothing_found({}).remedy, "vinyl"));
  CHECK(says(nothing_found({"serial:/dev/ttyUSB0"}).remedy, "--device serial:/dev/ttyUSB0"));
}

}  // namespace doctor_test
