// SPDX-License-Identifier: MIT
// Which of several cutters a job is planned for, and another plan for another one.
#include <string>

#include <fmt/format.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "tests/support/daemon_with_cli.hpp"
#include "tests/support/paths.hpp"

namespace plan_again_test {

using namespace popcut::testing;
using Json = nlohmann::json;

namespace {

const std::string kUnit = source_file("examples/unit.json");

/// Two cutters of two models.
struct Workshop : DaemonWithCli {
  explicit Workshop(const std::string& materials = "")
      : DaemonWithCli(0, "[[device]]\nid = \"sim:portrait3\"\ntime_scale = 0\n" + materials) {
    ::setenv("XDG_CONFIG_HOME", (daemon.folder() / "config").c_str(), 1);
    open();
  }
  ~Workshop() { ::unsetenv("XDG_CONFIG_HOME"); }
  Workshop(const Workshop&) = delete;
  Workshop& operator=(const Workshop&) = delete;
  [[nodiscard]] std::string ready(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words{"cut", "-q", kUnit};
    words.insert(words.end(), more.begin(), more.end());
    const Ran ran = popcut(words);
    INFO(ran.err);
    REQUIRE(ran.exit == 0);
    std::string id = first_line(ran.out);
    REQUIRE(comes_to(id, "ready"));
    return id;
  }
  /// Types the command that a refusal names.
  [[nodiscard]] Ran follow(const std::string& refusal, const std::string& command) const {
    const std::size_t at = refusal.find(command);
    INFO(refusal);
    REQUIRE(at != std::string::npos);
    std::string rest = refusal.substr(at, refusal.find_first_of(";,\n", at) - at);
    std::vector<std::string> words;
    for (std::size_t from = rest.find(' ') + 1, to; from < rest.size(); from = to + 1) {
      to = std::min(rest.find(' ', from), rest.size());
      words.push_back(rest.substr(from, to - from));
    }
    return popcut(words);
  }
};

bool warns(const Json& job, const std::string& code) {
  for (const Json& one : job["warnings"])
    if (one["code"] == code) return true;
  return false;
}

}  // namespace

TEST_CASE("a job is planned for the cutter that is set up for its material",
          "[popcutd][cli][plan-again]") {
  const Workshop shop("materials = [\"pp-150\"]\n");
  const Json here = shop.job(shop.ready({"--material", "pp-150"}));
  CHECK(here["load"]["machine"] == "portrait3");
  CHECK(here["load"]["side"] == "pop-up");
  CHECK_FALSE(warns(here, "cutter_chosen"));
  CHECK(shop.job(shop.ready({"--material", "paper-220"}))["load"]["machine"] == "cameo3");
}

TEST_CASE("where two models would do popcut says which it chose and how to choose the other",
          "[popcutd][cli][plan-again]") {
  const Workshop shop;
  const std::string id = shop.ready();
  const Json job = shop.job(id);
  CHECK(job["load"]["machine"] == "cameo3");
  CHECK(warns(job, "cutter_chosen"));
  CHECK(job["unaccepted_warnings"].empty());
  CHECK(says(shop.popcut({"jobs", id}).out,
             fmt::format("it can be planned again for sim:portrait3: popcut change {} --device ID",
                         id.substr(0, 12))));

  const Ran refused = shop.popcut({"arm", id, "1", "--device", "sim:portrait3"});
  CHECK(refused.exit == 5);
  const Ran again =
      shop.follow(refused.err, fmt::format("popcut change {} --device sim:portrait3", id));
  INFO(again.err);
  CHECK(again.exit == 0);
  REQUIRE(shop.comes_to(id, "ready"));
  const Json changed = shop.job(id);
  CHECK(changed["load"]["machine"] == "portrait3");
  CHECK(changed["plan"] != job["plan"]);
  CHECK_FALSE(warns(changed, "cutter_chosen"));
  CHECK(shop.popcut({"arm", id}).exit == 0);
  CHECK(shop.popcut({"start", id, "--wait"}).exit == 0);
  CHECK(shop.job(id)["device"] == "sim:portrait3");
}

TEST_CASE("another cutter or material is refused with the command that plans again",
          "[popcutd][cli][plan-again]") {
  const Workshop shop;
  const std::string id = shop.ready();
  const Ran device = shop.popcut({"change", id, "--device", "sim:portrait3"});
  CHECK(device.exit != 0);
  CHECK(says(device.err, fmt::format("popcut change {} --device sim:portrait3 --plan-again", id)));
  const Ran material = shop.popcut({"change", id, "--material", "pp-150"});
  CHECK(material.exit != 0);
  CHECK(says(material.err, "--plan-again"));
  CHECK(shop.popcut({"change", id, "--material", "pp-150", "--plan-again"}).exit == 0);
  REQUIRE(shop.comes_to(id, "ready"));
  CHECK(shop.job(id)["material"] == "pp-150");
  CHECK(shop.job(id)["load"]["material"] == "pp-150");
}

TEST_CASE("a job for a site waits until a cutter stands there or it is for any site",
          "[popcutd][cli][plan-again]") {
  const Workshop shop;
  const std::string id = shop.ready({"--site", "top floor"});
  CHECK(shop.job(id)["site"] == "top floor");
  CHECK(warns(shop.job(id), "no_cutter_at_site"));
  CHECK(says(shop.popcut({"jobs", id}).out, "no cutter is at site top floor"));
  const Ran refused = shop.popcut({"arm", id});
  CHECK(refused.exit == 5);
  CHECK(says(refused.err, "sim:cameo3: it is at no site; the job is for site top floor"));
  CHECK(says(refused.err, fmt::format("popcut change {} --site ''", id)));
  const Ran contrary =
      shop.popcut({"cut", "-q", kUnit, "--site", "top floor", "--device", "sim:cameo3"});
  CHECK(contrary.exit == 2);
  CHECK(says(contrary.err, "--site: is \"top floor\"; sim:cameo3 is at no site"));
  const Ran direct = shop.popcut({"cut", "--direct", kUnit, "--site", "top floor"});
  CHECK(direct.exit == 2);
  CHECK(shop.popcut({"change", id, "--site", ""}).exit == 0);
  CHECK(shop.job(id)["site"].is_null());
  CHECK_FALSE(warns(shop.job(id), "no_cutter_at_site"));
  CHECK(shop.popcut({"arm", id}).exit == 0);
}

TEST_CASE("a job of which something was cut keeps its plan", "[popcutd][cli][plan-again]") {
  const Workshop shop;
  const std::string id = shop.ready({"--copies", "2"});
  const Json before = shop.job(id);
  CHECK(shop.popcut({"arm", id}).exit == 0);
  const Ran armed = shop.popcut({"change", id, "--plan-again"});
  CHECK(armed.exit == 5);
  CHECK(shop.popcut({"start", id, "--wait"}).exit == 0);
  REQUIRE(shop.comes_to(id, "ready"));
  const Ran refused = shop.popcut({"change", id, "--device", "sim:portrait3", "--plan-again"});
  CHECK(refused.exit == 5);
  CHECK(says(refused.err, "cut already"));
  CHECK(!says(shop.popcut({"arm", id, "2", "--device", "sim:portrait3"}).err, "--plan-again"));
  CHECK(shop.job(id)["plan"] == before["plan"]);
}

}  // namespace plan_again_test
