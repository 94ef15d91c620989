// SPDX-License-Identifier: MIT
// Warnings on their way from a plan to the person who arms its sheet.
#include <string>

#include <fmt/format.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "tests/support/at_terminal.hpp"
#include "tests/support/daemon_with_cli.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/raw_http.hpp"

namespace warnings_test {

using namespace popcut::testing;
using Json = nlohmann::json;

namespace {

/// Nobody knows how large it is.
const std::string kNoUnit =
    R"(<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 200 200">)"
    R"(<path d="M20 20H120V120H20Z" fill="none" stroke="black" stroke-dasharray="9 3"/></svg>)";

struct Workshop : DaemonWithCli {
  Workshop() {
    ::setenv("XDG_CONFIG_HOME", (daemon.folder() / "config").c_str(), 1);
    open();
    write_file(daemon.folder() / "box.svg", kNoUnit);
  }
  ~Workshop() { ::unsetenv("XDG_CONFIG_HOME"); }
  Workshop(const Workshop&) = delete;
  Workshop& operator=(const Workshop&) = delete;
  [[nodiscard]] std::string ready() const {
    const Ran ran = popcut({"cut", "-q", (daemon.folder() / "box.svg").string()});
    INFO(ran.err);
    REQUIRE(ran.exit == 0);
    std::string id = first_line(ran.out);
    REQUIRE(comes_to(id, "ready"));
    return id;
  }
};

Json member(const Json& all, const std::string& code) {
  for (const Json& one : all)
    if (one["code"] == code) return one;
  return {};
}

}  // namespace

TEST_CASE("what may spoil a cut is shown when it is queued and accepted once before it is armed",
          "[popcutd][cli][warnings]") {
  const Workshop shop;
  const Ran queued = shop.popcut({"cut", (shop.daemon.folder() / "box.svg").string()});
  const std::string id = first_line(queued.out);
  INFO(queued.err);
  CHECK(says(queued.err, "warning: the drawing gives no unit of length"));
  CHECK(says(queued.err, "warning: 1 line has a dashed style"));
  const Json job = shop.job(id);
  CHECK(job["unaccepted_warnings"] == Json{"no_unit"});
  const Json size = member(job["warnings"], "no_unit"),
             dashed = member(job["warnings"], "dashed_line");
  CHECK(size["spoils"] == true);
  CHECK(size["place"].is_null());
  CHECK(dashed["spoils"] == false);
  CHECK(dashed["place"]["source"] == "line 1");
  for (const Ran& seen : {shop.popcut({"jobs"}), shop.popcut({"jobs", id})})
    CHECK(says(seen.out, "the drawing gives no unit of length"));

  const Ran refused = shop.popcut({"arm", id});
  INFO(refused.err);
  CHECK(refused.exit == 5);
  CHECK(says(refused.err, "the drawing gives no unit of length"));
  CHECK(!says(refused.err, "dashed style"));
  const std::string way = fmt::format("popcut arm {} 1 --accept-warnings", id);
  CHECK(says(refused.err, way));
  CHECK(shop.job(id)["state"] == "ready");

  CHECK(shop.popcut({"arm", id, "1", "--accept-warnings"}).exit == 0);
  CHECK(shop.job(id)["unaccepted_warnings"].empty());
  // Once: whoever has to arm it again is not asked again.
  CHECK(shop.popcut({"disarm", id}).exit == 0);
  CHECK(shop.popcut({"arm", id}).exit == 0);
  CHECK(shop.popcut({"start", id, "--wait"}).exit == 0);
}

TEST_CASE("a person at a terminal is asked before a cut that may be spoiled",
          "[popcutd][cli][warnings]") {
  const Workshop shop;
  const std::string id = shop.ready();
  for (const bool yes : {false, true}) {
    AtTerminal arm(popcut_program(), {"arm", id}, shop.daemon.folder());
    REQUIRE(arm.shows("Arm it anyway? [y/N]"));
    CHECK(says(arm.shown, "no unit of length"));
    arm.type(yes ? "y\n" : "\n");
    CHECK(arm.ended() == (yes ? 0 : 5));
    CHECK(shop.job(id)["state"] == (yes ? "armed" : "ready"));
  }
}

TEST_CASE("the refusal over HTTP names the warnings and the request that accepts them",
          "[popcutd][warnings]") {
  const Workshop shop;
  const std::string id = shop.ready();
  const auto arm = [&](const Json& body) {
    popcut::daemon::RawConnection connection(shop.daemon.socket());
    const std::string text = body.dump();
    connection.send(fmt::format(
        "POST /v1/jobs/{}/actions/arm HTTP/1.1\r\nHost: a\r\nContent-Type: application/json\r\n"
        "If-Match: \"{}\"\r\nIdempotency-Key: key-of-the-warnings-{}\r\nContent-Length: "
        "{}\r\n\r\n{}",
        id, shop.job(id)["rev"].dump(), body.dump().size(), text.size(), text));
    return connection.receive();
  };
  const auto refused = arm({{"sheet", 1}});
  REQUIRE(refused.status == 409);
  const Json problem = Json::parse(refused.body);
  CHECK(member(problem["warnings"], "no_unit")["spoils"] == true);
  REQUIRE(problem["ways"].size() == 1);
  const Json way = problem["ways"][0];
  CHECK(way["body"]["accept_warnings"] == Json{"no_unit"});
  // Not what somebody guesses, but what popcutd named.
  CHECK(arm({{"sheet", 1}, {"accept_warnings", {"all"}}}).status == 409);
  CHECK(arm({{"sheet", 1}, {"accept_warnings", "no_unit"}}).status == 422);
  CHECK(arm(way["body"]).status == 200);
}

TEST_CASE("a drawing whose colours nobody explained is refused where it is queued",
          "[popcutd][cli][warnings][reading]") {
  const Workshop shop;
  const auto file = shop.daemon.folder() / "colours.svg";
  write_file(file, R"(<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="80mm" )"
                   R"(viewBox="0 0 100 80" fill="none"><path stroke="black" d="M5 5H90V70H5Z"/>)"
                   R"(<path stroke="red" d="M5 40H90"/></svg>)");
  const Ran refused = shop.popcut({"cut", file.string()});
  INFO(refused.err);
  CHECK(refused.exit == 5);
  CHECK(says(refused.err, "2 colours (#000000, #ff0000)"));
  CHECK(says(refused.err, "--svg-profile origami-sim"));
  CHECK(says(refused.err, "--svg-profile popcut"));
  CHECK(shop.job(first_line(refused.out))["state"] == "failed");
  const Ran folded = shop.popcut({"cut", file.string(), "--svg-profile", "origami-sim"});
  INFO(folded.err);
  CHECK(folded.exit == 0);
  CHECK(shop.comes_to(first_line(folded.out), "ready"));
}

TEST_CASE("popcutd takes no job for a machine that popcut does not drive",
          "[popcutd][cli][warnings]") {
  const Workshop shop;
  for (const char* machine : {"cricut-maker", "none"}) {
    CAPTURE(machine);
    const Ran listed = shop.popcut({"devices"});
    CHECK(!says(listed.out, std::string("sim:") + machine));
    const Ran refused = run_program(
        {popcutd_program(), "--state", (shop.daemon.folder() / "other").string(), "--socket",
         (shop.daemon.folder() / "o.sock").string(), "--listen", "127.0.0.1:0", "--sim", machine},
        shop.daemon.folder().path(), {});
    INFO(refused.err);
    CHECK(refused.exit != 0);
    CHECK(says(refused.err, "takes no programs from popcut"));
  }
}

}  // namespace warnings_test
