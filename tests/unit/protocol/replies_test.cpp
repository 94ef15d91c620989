// SPDX-License-Identifier: MIT
#include <catch2/catch.hpp>

#include "tests/support/other_replies.hpp"

namespace replies_test {

using namespace popcut;

TEST_CASE("each status of a cutter is known and any other reply is never ready",
          "[protocol][replies][defects]") {
  CHECK(parse_status("0\x03") == DeviceStatus::Ready);
  CHECK(parse_status("1\x03") == DeviceStatus::Moving);
  CHECK(parse_status("2\x03") == DeviceStatus::NoMedia);
  CHECK(parse_status("3\x03") == DeviceStatus::Paused);
  CHECK(parse_status("4\x03") == DeviceStatus::Cancelled);
  CHECK(parse_status("0") == DeviceStatus::Ready);
  CHECK(parse_status("    0\x03") == DeviceStatus::Ready);
  for (const char* reply : {"", "\x03", "5\x03", "00\x03", "0\x03\x30\x03", "    \x03", "x", "0,0"})
    CHECK(parse_status(reply) == DeviceStatus::Unknown);
  CHECK(name_of(DeviceStatus::Paused) == "paused");
}

TEST_CASE("an identity is a model and its firmware", "[protocol][replies]") {
  const Identity cameo = parse_identity("CAMEO 3 V1.60    \x03").value();
  CHECK(cameo.model == "CAMEO 3");
  CHECK(cameo.firmware == "V1.60");
  const Identity portrait = parse_identity("Portrait V1.00    ").value();
  CHECK(portrait.model == "Portrait");
  CHECK(portrait.firmware == "V1.00");
  CHECK(parse_identity("CAMEO\x03").value().firmware.empty());
  CHECK(parse_identity("MODEL Vx").value().model == "MODEL Vx");
  for (const std::string& bad :
       {std::string(), std::string("   \x03"), std::string("a\x01"), std::string(65, 'x')})
    CHECK(parse_identity(bad).error().kind == ErrorKind::Malformed);
}

TEST_CASE("numbers in replies may be padded with blanks", "[protocol][replies]") {
  const NumberPair window = parse_pair("  6100,  4120\x03").value();
  CHECK(window.first == 6100);
  CHECK(window.second == 4120);
  CHECK(parse_pair("    0,    4").value().second == 4);
  CHECK(parse_number("   18\x03").value() == 18);
  CHECK(parse_pair("   18\x03").error().kind == ErrorKind::Malformed);
  CHECK(parse_number("1,2").error().kind == ErrorKind::Malformed);
  CHECK(parse_pair("1,x").error().detail == "the device replied \"1,x\"; 2 numbers were expected");
  CHECK(parse_pair("1,\x1b").error().detail.find('\x1b') == std::string::npos);
  CHECK_FALSE(parse_pair(std::string(100, '1')));
}

TEST_CASE("tools and positions are read from their replies", "[protocol][replies]") {
  CHECK(parse_tools("2,0\x03").value() == std::vector<int>{2, 0});
  CHECK(parse_tools("7").value() == std::vector<int>{7});
  for (const char* reply : {"", "2,,0", "1.5", "256", "-1", "x", "1,2,3,4,5,6,7,8,9"}) {
    CAPTURE(reply);
    CHECK_FALSE(parse_tools(reply));
  }
  CHECK(tool_name(2) == "autoblade");
  CHECK(tool_name(6) == "unknown tool");
  const NumberPair at = parse_position("   100,   300,    20\x03").value();
  CHECK(at.first == 100);
  CHECK(at.second == 300);
  CHECK_FALSE(parse_position("100,300"));
}

}  // namespace replies_test
