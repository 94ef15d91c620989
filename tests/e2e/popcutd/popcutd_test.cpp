// SPDX-License-Identifier: MIT
// popcutd and popcut together, as people use them: jobs.
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <future>
#include <string>
#include <thread>
#include <vector>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "tests/support/daemon_with_cli.hpp"
#include "tests/support/paths.hpp"

namespace popcutd_test {

using namespace popcut::testing;
using Json = nlohmann::json;
namespace fs = std::filesystem;

namespace {

const std::string kSphere = source_file("examples/sphere.json");
const std::string kUnit = source_file("examples/unit.json");

/// The stored program of sheet 1 does what the knife did, and what its drawing says.
void check_trace(const DaemonWithCli& lab, const std::string& job) {
  const std::string plan = lab.job(job)["plan"];
  const fs::path folder = fs::path(lab.daemon.state()) / "plans" / plan;
  const Ran ran =
      lab.popcut({"simulate", (folder / "sheet-01.gpgl").string(), "-o", "sim", "--machine",
                  "cameo3", "--expect", (folder / "sheet-01.svg").string()});
  INFO(ran.err);
  REQUIRE(ran.exit == 0);
  const Json planned = Json::parse(text_of_file(lab.daemon.folder() / "sim/trace.json"));
  const Json done = lab.trace();
  CHECK(done["strokes"] == planned["strokes"]);
  CHECK(done["lifts"] == planned["lifts"]);
  CHECK(done["strokes"].size() > 100);
}

}  // namespace

TEST_CASE("the commands of the manual take a job from a spec to a cut sheet", "[popcutd][e2e]") {
  DaemonWithCli lab;
  lab.open();
  auto waiting = std::async(std::launch::async, [&] {
    return lab.popcut({"cut", kSphere, "--wait"});
  });
  const auto begun = std::chrono::steady_clock::now();
  std::string list;
  while (list.find("-> load sheet 1 of 1: popcut arm") == std::string::npos &&
         std::chrono::steady_clock::now() - begun < std::chrono::seconds(60))
    list = lab.popcut({"jobs"}).out;
  const Ran arm = lab.popcut({"arm"});
  INFO(arm.err);
  REQUIRE(arm.exit == 0);
  CHECK(arm.err.find("popcut start") != std::string::npos);
  const Ran start = lab.popcut({"start"});
  INFO(start.err);
  REQUIRE(start.exit == 0);
  const Ran cut = waiting.get();
  INFO(cut.err);
  CHECK(cut.exit == 0);
  CHECK(cut.err.find("sphere: done") != std::string::npos);
  const std::string id = first_line(cut.out);
  CHECK(lab.job(id)["state"] == "done");
  check_trace(lab, id);
  const Ran shown = lab.popcut({"jobs", id.substr(0, 20)});
  CHECK(shown.out.find("sheet 1    done         378 paths") != std::string::npos);
  CHECK(lab.popcut({"usage"}).out.find(",1\r\n") != std::string::npos);
  CHECK((DaemonProcess::fleet_section != nullptr ||
         lab.popcut({"db", "check"}).out == "result: ok\n"));
  lab.daemon.signal(SIGTERM);
  CHECK(lab.daemon.wait() == 0);
}

TEST_CASE("curl with a token over TCP can do the same", "[popcutd][e2e]") {
  DaemonWithCli lab;
  lab.open();
  if (run_program({"/usr/bin/env", "curl", "--version"}, "/").exit != 0) {
    WARN("skipped: there is no curl here");
    return;
  }
  const auto curl = [&](std::vector<std::string> words) {
    words.insert(words.begin(), {"/usr/bin/env", "curl", "-sS", "--fail-with-body"});
    const Ran ran = run_program(words, "/");
    INFO(ran.out << ran.err);
    REQUIRE(ran.exit == 0);
    return Json::parse(ran.out);
  };
  const std::string json = "Content-Type: application/json";
  const Json token = curl({"--unix-socket", lab.daemon.socket(), "http://localhost/v1/tokens", "-H",
                           json, "-d", R"({"name": "curl", "role": "operator"})"});
  const std::string url = lab.daemon.url();
  const std::string bearer = "Authorization: Bearer " + token["token"].get<std::string>();
  const Json api = curl({url + "/v1/openapi.json", "-H", bearer});
  CHECK(api["paths"].contains("/v1/jobs/{id}/actions/start"));
  const Json design = curl(
      {url + "/v1/designs?name=sphere", "-H", bearer, "-H", json, "--data-binary", "@" + kSphere});
  Json job =
      curl({url + "/v1/jobs", "-H", bearer, "-H", json, "-H",
            "Idempotency-Key: 0123456789abcdef-job", "-d", Json{{"design", design["id"]}}.dump()});
  const std::string at = url + "/v1/jobs/" + job["id"].get<std::string>();
  while (job["state"] != "ready") {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    job = curl({at, "-H", bearer});
    REQUIRE(job["state"] != "failed");
  }
  const auto act = [&](const std::string& action, const Json& body) {
    job = curl({at + "/actions/" + action, "-H", bearer, "-H", json, "-H",
                "If-Match: \"" + job["rev"].dump() + "\"", "-H",
                "Idempotency-Key: 0123456789abcdef-" + action, "-d", body.dump()});
  };
  act("arm", {{"sheet", 1}, {"blank", 1}});
  act("start", {{"sheet", 1}});
  while (job["state"] == "cutting") {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    job = curl({at, "-H", bearer});
  }
  CHECK(job["state"] == "done");
  check_trace(lab, job["id"]);
}

TEST_CASE("popcut and popcutd work together without any configuration", "[popcutd][e2e]") {
  const TempFolder home;
  const std::string run = (home / "run").string();
  fs::create_directory(run);
  for (const char* name : {"POPCUT_URL", "POPCUT_TOKEN", "XDG_STATE_HOME", "XDG_CONFIG_HOME"})
    ::unsetenv(name);
  ::setenv("HOME", home.path().c_str(), 1);
  ::setenv("XDG_RUNTIME_DIR", run.c_str(), 1);
  const std::string script =
      "popcutd 2>popcutd.log & daemon=$!\n"
      "trap 'kill $daemon; wait $daemon' EXIT\n"
      "for k in $(seq 600); do popcut jobs -q 2>/dev/null && break; sleep 0.1; done\n"
      "popcut cut " +
      kUnit +
      " --wait & cut=$!\n"
      "for k in $(seq 600); do popcut arm 2>/dev/null && break; sleep 0.1; done\n"
      "popcut start\n"
      "wait $cut\n";
  const std::string folders = fs::path(popcut_program()).parent_path().string() + ":" +
                              fs::path(popcutd_program()).parent_path().string();
  ::setenv("PATH", (folders + ":" + std::getenv("PATH")).c_str(), 1);
  const Ran ran = run_program({"/bin/bash", "-c", script}, home.path());
  const std::string log = text_of_file(home / "popcutd.log");
  INFO(ran.out << ran.err << log);
  if (log.find("8631") != std::string::npos && log.find("serving") == std::string::npos) {
    WARN("skipped: port 8631 is taken here");
    return;
  }
  CHECK(ran.exit == 0);
  CHECK(ran.err.find("unit: done") != std::string::npos);
  CHECK(log.find("http://127.0.0.1:8631") == std::string::npos);  // no terminal, no greeting
  CHECK(fs::exists(home / ".local/state/popcut/popcut.db"));
}

TEST_CASE("a stop while cutting ends after the stroke and the job reports it", "[popcutd][e2e]") {
  DaemonWithCli lab(10);
  lab.open();
  const std::string id = first_line(lab.popcut({"cut", kSphere, "-q"}).out);
  REQUIRE(lab.until_done({"arm", id, "1"}).exit == 0);
  REQUIRE(lab.popcut({"start", id}).exit == 0);
  REQUIRE(lab.comes_to(id, "cutting"));
  std::this_thread::sleep_for(std::chrono::milliseconds(1500));
  lab.daemon.signal(SIGTERM);
  CHECK(lab.daemon.wait() == 0);
  lab.open();
  const Json job = lab.job(id);
  CHECK(job["state"] == "interrupted");
  CHECK(job["reason"] == "shutdown");
  const Ran list = lab.popcut({"jobs"});
  CHECK(list.out.find("popcut retry " + id.substr(0, 12) + " 1") != std::string::npos);
  CHECK(lab.popcut({"start", id}).exit == 5);
  REQUIRE(lab.popcut({"retry", id, "1"}).exit == 0);
  CHECK(lab.job(id)["blank"] == 2);
  CHECK(lab.popcut({"cancel", id, "--reason", "enough"}).exit == 0);
  CHECK(lab.job(id)["state"] == "cancelled");
}

TEST_CASE("plan options and the files of a spec are sent with a job", "[popcutd][e2e]") {
  DaemonWithCli lab;
  lab.open();
  // A grid that the spec names by its file goes up first.
  std::string grid;
  for (int column = 0; column < 12; ++column) grid += "," + std::to_string(3 * column);
  for (int row = 0; row < 12; ++row) {
    grid += "\n" + std::to_string(3 * row);
    for (int column = 0; column < 12; ++column)
      grid += "," + std::to_string(60.0 - 6.0 * column - 0.1 * row * row);
  }
  write_file(lab.daemon.folder() / "heights.csv", grid);
  write_file(lab.daemon.folder() / "hill.json",
             R"({"popcut": 1, "name": "hill", "surface": {"type": "grid", "file": "heights.csv"},
                 "scale_mm": 1, "units_per_slice": 3, "slices": 4, "widths_mm": 2})");
  const Ran hill = lab.popcut({"cut", "hill.json"});
  CAPTURE(hill.err);
  CHECK(hill.exit == 0);
  CHECK(hill.err.find("uploading heights.csv") != std::string::npos);
  REQUIRE(fs::exists(lab.daemon.state() + "/assets"));
  CHECK(files_below(lab.daemon.state() + "/assets").size() == 1);
  write_file(lab.daemon.folder() / "lost.json",
             R"({"popcut": 1, "surface": {"type": "grid", "file": "absent.csv"},
                 "units_per_slice": 3, "slices": 4, "widths_mm": 2})");
  const Ran lost = lab.popcut({"cut", "lost.json"});
  CHECK(lost.exit == 3);
  CHECK(lost.err.find("lost.json: /surface/file: absent.csv") != std::string::npos);

  const std::string id = first_line(
      lab.popcut({"cut", kUnit, "-q", "--order", "keep", "--material", "pp-150", "--copies", "3"})
          .out);
  REQUIRE(lab.comes_to(id, "ready"));
  CHECK(lab.job(id)["sheets_total"] == 3);
  CHECK(lab.job(id)["material"] == "pp-150");
  CHECK(lab.job(id)["handwork"]["folds"] == 5);
  CHECK(lab.job(id)["handwork"]["label"] == "easy");
  CHECK(says(lab.popcut({"jobs", id}).out, "by hand    5 folds, the shortest"));
  const Ran wrong = lab.popcut({"cut", kUnit, "--material", "pp-15"});
  CHECK(wrong.exit == 2);
  CHECK(wrong.err.find("--material") != std::string::npos);
  CHECK(lab.popcut({"cut", source_file("README.md")}).exit == 3);
}

TEST_CASE("the view of jobs has all of them and each change", "[popcutd][e2e]") {
  DaemonWithCli lab;
  lab.open();
  const std::string one = first_line(lab.popcut({"cut", kUnit, "-q"}).out);
  const std::string two = first_line(lab.popcut({"cut", kUnit, "-q", "--name", "gift card"}).out);
  REQUIRE(lab.comes_to(one, "ready"));
  REQUIRE(lab.comes_to(two, "ready"));
  CHECK(lab.popcut({"arm"}).exit == 2);  // which of the two?
  CHECK(lab.popcut({"arm", one.substr(0, 4)}).exit == 2);
  const std::string file = lab.daemon.folder() / "view";
  const pid_t view = ::fork();
  REQUIRE(view >= 0);
  if (view == 0) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (std::freopen(file.c_str(), "w", stdout) == nullptr) ::_exit(126);
    ::execl(popcut_program(), popcut_program(), "jobs", "--watch", nullptr);
    ::_exit(127);
  }
  const auto shows = [&](const std::string& words) {
    const auto begun = std::chrono::steady_clock::now();
    while (text_of_file(file).find(words) == std::string::npos) {
      if (std::chrono::steady_clock::now() - begun > std::chrono::seconds(60)) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return true;
  };
  CHECK(shows(one.substr(0, 12) + " unit: ready"));
  CHECK(shows(two.substr(0, 12) + " gift card: ready"));
  CHECK(lab.popcut({"cancel", two, "-q"}).exit == 0);
  CHECK(shows(two.substr(0, 12) + " gift card: cancelled"));
  ::kill(view, SIGINT);
  CHECK(::waitpid(view, nullptr, 0) == view);
  CHECK(lab.popcut({"jobs", "--state", "cancelled"}).out.find("gift card") != std::string::npos);
  CHECK(lab.popcut({"hold", one}).exit == 0);
  CHECK(lab.popcut({"jobs"}).out.find("held") != std::string::npos);
  CHECK(lab.popcut({"release", one}).exit == 0);
  CHECK(lab.popcut({"pause", one}).exit == 5);
  CHECK(lab.popcut({"events", "--job", one, "--json"}).out.find("\"planning\"") !=
        std::string::npos);
}

}  // namespace popcutd_test
