// SPDX-License-Identifier: MIT
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "daemon/cli/job_view.hpp"

using namespace popcut::cli;
using Json = nlohmann::json;

namespace {

Json job(const std::string& state) {
  return {{"id", "01JDX7KQ4M8ZB1Q2R3S4T5V6W7"},
          {"name", "sphere"},
          {"state", state},
          {"device", "sim:cameo3"},
          {"sheet", 2},
          {"sheets_total", 3},
          {"blank", 1},
          {"reason", nullptr},
          {"progress", {{"paths_certain", 30}, {"paths_sent", 50}, {"paths_total", 200}}},
          {"est", {{"remaining_s", {60.0, 80.0}}}},
          {"actions", Json::array()}};
}

std::string joined(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  return text;
}

}  // namespace

TEST_CASE("each thing that waits for a person comes with the command to type", "[cli][jobs]") {
  Json ready = job("ready");
  ready["actions"] = {"arm", "cancel"};
  CHECK(joined(waiting_for(ready)) ==
        "load sheet 2 of 3 into sim:cameo3: popcut arm 01JDX7KQ4M8Z 2\n");
  ready["blank"] = 2;
  CHECK(joined(waiting_for(ready)).find("blank 2") != std::string::npos);
  CHECK(joined(waiting_for(job("armed"))).find("popcut start 01JDX7KQ4M8Z") != std::string::npos);
  CHECK(waiting_for(job("paused")).empty());  // its cancel is under way
  Json paused = job("paused");
  paused["actions"] = {"resume", "cancel"};
  CHECK(joined(waiting_for(paused)).find("popcut resume") != std::string::npos);
  Json interrupted = job("interrupted");
  interrupted["actions"] = {"retry-sheet", "resume-from", "confirm-result", "cancel"};
  interrupted["reason"] = "unplug";
  const std::string ways = joined(waiting_for(interrupted));
  CHECK(ways.find("interrupted by unplug; 30 paths are certainly cut, 20 more are in doubt") !=
        std::string::npos);
  for (const char* way : {"popcut retry 01JDX7KQ4M8Z 2", "--from", "good", "popcut cancel"})
    CHECK(ways.find(way) != std::string::npos);
  interrupted["actions"] = {"retry-sheet", "cancel"};
  CHECK(joined(waiting_for(interrupted)).find("good") == std::string::npos);
  CHECK(waiting_for(job("cutting")).empty());
  CHECK(waiting_for(job("queued")).empty());
  Json absent = job("ready");
  absent["attention"] = {{"kind", "device_absent"}, {"text", "plug it in"}};
  CHECK(joined(waiting_for(absent)) == "plug it in\n");
}

TEST_CASE("the live view has running knives first and shows how far they are", "[cli][jobs]") {
  Json done = job("done"), ready = job("ready");
  ready["actions"] = {"arm"};
  const auto lines = jobs_view({job("queued"), done, ready, job("cutting")}, {});
  REQUIRE(lines.size() == 5);
  CHECK(lines[0].find("cutting") != std::string::npos);
  CHECK(lines[0].find("[####............]  25 %  1:20 left") != std::string::npos);
  CHECK(lines[1].find("ready") != std::string::npos);
  CHECK(lines[2].find("-> load sheet") != std::string::npos);
  CHECK(lines[3].find("queued") != std::string::npos);
  CHECK(lines[4].find("done") != std::string::npos);
}

TEST_CASE("the view stands whatever it is given", "[cli][jobs]") {
  Json odd = job("ready");
  odd["name"] =
      "\x1b[31mred\x07\xc2\x9b"
      "2J\xe2\x80\xaegnp\xe2\x81\xa6";
  odd["sheet"] = "two";
  odd["progress"] = 7;
  odd["est"] = {{"remaining_s", "soon"}};
  odd["actions"] = "arm";
  odd["attention"] = Json::array();
  const std::string text = joined(jobs_view({odd, Json::object(), Json(3)}, {}));
  CHECK(text.find('\x1b') == std::string::npos);
  CHECK(text.find('\x07') == std::string::npos);
  CHECK(text.find("\xc2\x9b") == std::string::npos);
  CHECK(text.find("\xe2\x80\xae") == std::string::npos);
  CHECK(text.find("\xe2\x81\xa6") == std::string::npos);
  CHECK_FALSE(job_details(odd, {Json::object()}).empty());
  Json wide = job("cutting");
  wide["name"] = "\xC3\xA9\xC3\xA9\xC3\xA9";
  for (const std::string& line : jobs_view({wide}, {15, false})) CHECK(line.size() <= 18);
}
