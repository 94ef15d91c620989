// SPDX-License-Identifier: MIT
// What popcut says of a popcutd: its devices, its refusals in the words of the command line, its
// configuration while it runs.
#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <functional>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "tests/support/at_terminal.hpp"
#include "tests/support/daemon_with_cli.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/raw_http.hpp"

namespace popcutd_command_test {

using namespace popcut::testing;
using Json = nlohmann::json;

namespace {

const std::string kUnit = source_file("examples/unit.json");

/// A popcutd and its client, with users' tables of their own.
struct Workshop : DaemonWithCli {
  explicit Workshop(const std::string& more = "", double time_scale = 0)
      : DaemonWithCli(time_scale, more) {
    ::setenv("XDG_CONFIG_HOME", (daemon.folder() / "config").c_str(), 1);
  }
  ~Workshop() { ::unsetenv("XDG_CONFIG_HOME"); }
  Workshop(const Workshop&) = delete;
  Workshop& operator=(const Workshop&) = delete;
  void table(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories(daemon.folder() / "config/popcut");
    write_file(daemon.folder() / "config/popcut" / name, text);
  }
  /// Waits until the command succeeds.
  Ran must(const std::vector<std::string>& words) const {
    Ran ran = until_done(words);
    INFO(ran.err);
    CHECK(ran.exit == 0);
    return ran;
  }
  [[nodiscard]] std::string queue(const std::vector<std::string>& words = {kUnit}) const {
    std::vector<std::string> all{"cut", "-q"};
    all.insert(all.end(), words.begin(), words.end());
    const Ran ran = popcut(all);
    INFO(ran.err);
    REQUIRE(ran.exit == 0);
    return ran.out.substr(0, 26);
  }
  /// Reloads the configuration with `text` at its end; what the log says about it.
  [[nodiscard]] std::string reloaded(const std::string& text) const {
    const std::string before = daemon.log(), file = text_of_file(daemon.config());
    write_file(daemon.config(), file + text);
    daemon.signal(SIGHUP);
    const bool told = comes_true([&] {
      const std::string after = daemon.log().substr(before.size());
      return after.ends_with('\n') &&
             (says(after, "configuration reloaded") || says(after, "was not loaded"));
    });
    CHECK(told);
    return daemon.log().substr(before.size());
  }
};

}  // namespace

TEST_CASE("devices lists popcutd's devices with their states", "[popcutd][cli]") {
  Workshop shop("[[device]]\nid = \"sim:portrait3\"\nmaterials = [\"pp-150\"]\ntime_scale = 0\n");
  const Ran alone = shop.popcut({"devices"});
  CHECK(alone.exit == 0);
  CHECK_FALSE(says(alone.out, "popcutd at"));
  CHECK(Json::parse(shop.popcut({"devices", "--json"}).out)["popcutd"].is_null());
  shop.open();
  const Ran ran = shop.popcut({"devices"});
  CHECK(ran.exit == 0);
  CHECK(says(ran.out, "popcutd at " + shop.daemon.socket()));
  CHECK(says(ran.out, "set up for pp-150"));
  CHECK(says(ran.out, "\nsim:cameo4"));
  const Json json = Json::parse(shop.popcut({"devices", "--json"}).out);
  REQUIRE(json["popcutd"]["devices"].size() == 2);
  CHECK(json["popcutd"]["devices"][1]["materials"] == Json{"pp-150"});
  CHECK(json["popcutd"]["devices"][1]["machine"] == "portrait3");

  CHECK(shop.popcut({"devices", "disable", "sim:cameo3"}).exit == 0);
  const Ran off = shop.popcut({"devices"});
  CHECK(says(off.out, "sim:cameo3                 disabled"));
  CHECK(says(off.out, "-> popcut devices enable sim:cameo3"));
  const Ran test = shop.popcut({"cut", "--test", "--device", "sim:cameo3"});
  CHECK(test.exit == 5);
  CHECK(says(test.err, "an admin can enable it; possible now: popcut devices enable sim:cameo3"));
  CHECK(Json::parse(shop.popcut({"devices", "enable", "sim:cameo3", "--json"}).out)["enabled"] ==
        true);
  CHECK(shop.popcut({"devices", "reset", "sim:cameo3"}).exit == 0);
  const Ran none = shop.popcut({"devices", "reset", "sim:cameo33"});
  CHECK(none.exit == 5);
  CHECK(says(none.err, "did you mean sim:cameo3"));
}

TEST_CASE("a test cut goes through popcutd with a person at each step", "[popcutd][cli]") {
  Workshop shop;
  shop.open();
  CHECK(shop.popcut({"cut", "--test", "--copies", "2"}).exit == 2);
  CHECK(shop.popcut({"cut", "--test", "--material", "papier"}).exit == 2);
  const std::string id = shop.queue({"--test", "--material", "pp-150"});
  REQUIRE(shop.comes_to(id, "ready"));
  CHECK(shop.job(id)["material"] == "pp-150");
  CHECK(shop.job(id)["name"] == "test cut");
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  CHECK(shop.job(id)["state"] == "ready");  // nothing moves by itself
  CHECK(shop.must({"arm"}).exit == 0);
  CHECK(shop.must({"start", "--wait"}).exit == 0);
  CHECK(shop.job(id)["state"] == "done");
}

TEST_CASE("a refusal names the command to type", "[popcutd][cli]") {
  Workshop shop;
  shop.open();
  const Ran mat = shop.popcut({"cut", kUnit, "--device", "sim:cameo33"});
  CHECK(mat.exit == 2);
  CHECK(says(mat.err, "popcut: --device: is \"sim:cameo33\"; did you mean sim:cameo3"));
  const std::string first = shop.queue(), second = shop.queue();
  REQUIRE(shop.comes_to(first, "ready"));
  REQUIRE(shop.comes_to(second, "ready"));
  const Ran which = shop.popcut({"arm"});
  CHECK(which.exit == 2);
  CHECK(says(which.err, "name one of"));
  const Ran prefix = shop.popcut({"arm", first.substr(0, 4)});
  CHECK(prefix.exit == 2);
  CHECK(says(prefix.err, "give more letters"));
  CHECK(shop.must({"arm", first, "--device", "sim:cameo3"}).exit == 0);
  const Ran busy = shop.popcut({"arm", second});
  CHECK(busy.exit == 5);
  CHECK(says(busy.err, "holds a sheet of job " + first));
  CHECK(shop.must({"disarm", first}).exit == 0);
  CHECK(shop.must({"change", second, "--priority", "3", "--note", "for two"}).exit == 0);
  CHECK(shop.job(second)["priority"] == 3);
  CHECK(shop.popcut({"change", second}).exit == 2);
  CHECK(says(shop.popcut({"change", second, "--device", "sim:nil"}).err, "popcut: --device: "));
  CHECK(shop.must({"cancel", second}).exit == 0);
  const Ran over = shop.popcut({"change", second, "--priority", "1"});
  CHECK(over.exit == 5);
  CHECK(says(over.err, "it is cancelled"));

  for (const char* limit : {"1", "3", "1000"}) {
    const Json events = Json::parse(shop.popcut({"events", "--limit", limit, "--json"}).out);
    CHECK(events["items"].back()["seq"] == events["last_seq"]);
    CHECK(events["items"].size() <= static_cast<std::size_t>(std::stoi(limit)));
  }
  const Json some =
      Json::parse(shop.popcut({"events", "--after", "1", "--limit", "2", "--json"}).out);
  CHECK(some["items"][0]["seq"] == 2);
  CHECK(some["items"].size() == 2);
}

TEST_CASE("jobs are listed in the order of the queue", "[popcutd][cli]") {
  Workshop shop;
  shop.open();
  std::vector<std::string> ids;
  for (int k = 0; k < 3; ++k) {
    ids.push_back(shop.queue());
    REQUIRE(shop.comes_to(ids.back(), "ready"));
  }
  const auto listed = [&] {
    const std::string text = shop.popcut({"jobs"}).out;
    std::vector<std::string> order = ids;
    std::sort(order.begin(), order.end(), [&](const std::string& a, const std::string& b) {
      return text.find(a.substr(0, 12)) < text.find(b.substr(0, 12));
    });
    return order;
  };
  CHECK(listed() == ids);
  const Ran moved = shop.must({"move", ids[2], "--before", ids[0]});
  CHECK(says(moved.err, "is now before " + ids[0]));
  CHECK(listed() == std::vector{ids[2], ids[0], ids[1]});
  CHECK(says(shop.must({"move", ids[2]}).err, "is now last of its priority"));
  CHECK(listed() == ids);
  const Ran itself = shop.popcut({"move", ids[1], "--before", ids[1]});
  CHECK(itself.exit == 2);
  CHECK(says(itself.err, "popcut: --before: " + ids[1] + " is the job to move"));
  CHECK(listed() == ids);
}

TEST_CASE("metrics have all documented names and name no user", "[popcutd][cli]") {
  Workshop shop;
  shop.open();
  const std::string id = shop.queue({kUnit, "--name", "secret name"});
  REQUIRE(shop.comes_to(id, "ready"));
  shop.must({"arm"});
  shop.must({"start", "--wait"});
  std::string text;
  CHECK(comes_true([&] {  // that who waited has gone is not noticed at once
    popcut::daemon::RawConnection connection(shop.daemon.socket());
    connection.send("GET /metrics HTTP/1.1\r\nHost: a\r\n\r\n");
    return says(text = connection.receive().body, "popcut_sse_clients 0\n");
  }));
  for (const char* line : {"popcut_jobs{state=\"done\"} 1\n", "popcut_queue_oldest_seconds 0",
                           "popcut_sheets_total{device=\"sim:cameo3\",outcome=\"done\"} 1\n",
                           "popcut_cut_mm_total{device=\"sim:cameo3\"} ",
                           "popcut_usb_errors_total{device=\"sim:cameo3\",kind=\"nodev\"} 0\n",
                           "popcut_usb_write_seconds_bucket{device=\"sim:cameo3\",le=\"+Inf\"} ",
                           "popcut_usb_write_seconds_count{device=\"sim:cameo3\"} ",
                           "popcut_db_commit_seconds_bucket{le=\"+Inf\"} ", "popcut_db_free_bytes ",
                           "popcut_http_requests_total{route=\"/v1/jobs/{id}\",code=\"200\"} ",
                           "# TYPE popcut_http_rejected counter\n", "popcut_sse_clients 0\n",
                           "popcut_sse_dropped_total ", "# TYPE popcut_interrupted counter\n",
                           "popcut_build_info{version=\""}) {
    CAPTURE(line, text);
    CHECK(says(text, line));
  }
  CHECK_FALSE(says(text, "popcut_usb_write_seconds_count{device=\"sim:cameo3\"} 0\n"));
  for (const char* private_part : {"secret name", "uid:", id.c_str()})
    CHECK(!says(text, private_part));
  CHECK(text.ends_with("# EOF\n"));
  // A type stands once, before its samples.
  std::map<std::string, int> types;
  for (std::size_t at = 0; (at = text.find("# TYPE ", at)) != std::string::npos; ++at)
    ++types[text.substr(at, text.find('\n', at) - at)];
  for (const auto& [type, count] : types) {
    CAPTURE(type);
    CHECK(count == 1);
  }
}

TEST_CASE("a file whose name is not UTF-8 is queued under a UTF-8 name", "[popcutd][cli]") {
  Workshop shop;
  shop.open();
  const std::string odd = (shop.daemon.folder() / "un\xFFit\x01.json").string();
  write_file(odd, text_of_file(kUnit));
  CHECK(shop.job(shop.queue({odd}))["name"] == "un\xEF\xBF\xBDit ");
}

TEST_CASE("without a terminal a job that needs a person is reported at once", "[popcutd][cli]") {
  Workshop shop;
  shop.open();
  const std::string popcut = popcut_program();
  const std::string script = "'" + popcut + "' cut '" + kUnit +
                             "' --wait 2>told.txt & job=$!\n"
                             "for k in $(seq 600); do grep -q 'popcut arm' told.txt && break; "
                             "sleep 0.1; done\n"
                             "cp told.txt early.txt\n'" +
                             popcut + "' cancel -q 0\nwait $job\n";
  const Ran ran = run_program({"/bin/sh", "-c", script}, shop.daemon.folder().path());
  CHECK(ran.exit == 5);
  CHECK(says(text_of_file(shop.daemon.folder() / "early.txt"), "-> load sheet 1 of 1: popcut arm"));
  CHECK(says(text_of_file(shop.daemon.folder() / "told.txt"), "is cancelled by "));
}

TEST_CASE("Ctrl-C stops watching and does not stop the job", "[popcutd][cli]") {
  Workshop shop;
  shop.open();
  AtTerminal person(popcut_program(), {"cut", kUnit, "--wait"}, shop.daemon.folder());
  REQUIRE(person.shows("popcut arm"));
  person.type("\x03");
  CHECK(person.shows("goes on in popcutd; 'popcut jobs"));
  CHECK(person.ended() == 5);
  const Json jobs = Json::parse(shop.popcut({"jobs", "--json"}).out)["jobs"];
  REQUIRE(jobs.size() == 1);
  CHECK(jobs[0]["state"] == "ready");
}

TEST_CASE("the live view fits a small terminal and ends with Ctrl-C", "[popcutd][cli]") {
  Workshop shop;
  shop.open();
  for (int k = 0; k < 8; ++k) (void)shop.queue({kUnit, "--name", "a name that is far too long"});
  const winsize size{8, 40, 0, 0};
  int master = -1;
  const pid_t child = ::forkpty(&master, nullptr, nullptr, &size);
  REQUIRE(child >= 0);
  if (child == 0) {
    ::execl(popcut_program(), popcut_program(), "jobs", "--watch", nullptr);
    ::_exit(127);
  }
  std::string text;
  std::array<char, 4096> room{};
  bool typed = false;
  for (ssize_t got = 0; (got = ::read(master, room.data(), room.size())) > 0;) {
    text.append(room.data(), static_cast<std::size_t>(got));
    if (!typed && says(text, "a name that") && says(text, "ready")) {
      typed = true;
      CHECK(::write(master, "\x03", 1) == 1);
    }
  }
  int status = 0;
  CHECK(::waitpid(child, &status, 0) == child);
  ::close(master);
  CHECK(typed);
  CHECK(WIFEXITED(status));
  CHECK(WEXITSTATUS(status) == 0);
  // The terminal itself shows the key, wherever the view is just then.
  if (const std::size_t key = text.find("^C"); key != std::string::npos) text.erase(key, 2);
  // No line is wider than the terminal, so none breaks and the view stays in its place.
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find("\r\n", at), text.size());
    std::string line = text.substr(at, end - at);
    for (std::size_t esc = 0; (esc = line.find('\x1b')) != std::string::npos;)
      line.erase(esc, line.find_first_of("ABCDHJKm", esc + 2) - esc + 1);
    if (const std::size_t back = line.rfind('\r'); back != std::string::npos)
      line.erase(0, back + 1);
    CAPTURE(line);
    CHECK(line.size() <= 40);
    at = end + 2;
  }
}

TEST_CASE("the user's machines and materials and SVG profiles reach popcutd", "[popcutd][cli]") {
  Workshop shop("[[device]]\nid = \"sim:ours\"\ntime_scale = 0\n");
  shop.table("machines.json",
             R"({"popcut": 1, "machines": [{"name": "ours", "like": "cameo3", "title": "Ours"}]})");
  shop.table("materials.json",
             R"({"popcut": 1, "materials": [{"name": "kraft", "like": "paper-220"}]})");
  shop.table("svg_profiles.json", R"({"popcut": 1, "svg_profiles": [
    {"name": "lab", "title": "blue is cut and all else is not", "otherwise": "ignore",
     "fills": "ignore", "rules": [{"colour": "#0000ff", "use": "cut"}]}]})");
  shop.open();
  write_file(shop.daemon.folder() / "lines.svg",
             "<svg xmlns='http://www.w3.org/2000/svg' width='100mm' height='100mm' "
             "viewBox='0 0 100 100'><path fill='none' stroke='#0000ff' d='M10,10h50'/>"
             "<path fill='none' stroke='#ff0000' d='M10,20h70'/></svg>");
  const std::string id = shop.queue(
      {"lines.svg", "--svg-profile", "lab", "--material", "kraft", "--device", "sim:ours"});
  REQUIRE(shop.comes_to(id, "ready"));
  const Json job = shop.job(id);
  CHECK(job["material"] == "kraft");
  CHECK(job["progress"]["paths_total"] == 1);
  const std::string other =
      shop.queue({"lines.svg", "--svg-profile", "popcut", "--device", "sim:ours"});
  REQUIRE(shop.comes_to(other, "ready"));
  CHECK(shop.job(other)["progress"]["paths_total"] == 2);
  CHECK(shop.popcut({"cut", "lines.svg", "--svg-profile", "labb"}).exit == 5);  // found by the plan
  shop.daemon.signal(SIGTERM);
  CHECK(shop.daemon.wait() == 0);
  shop.table("svg_profiles.json", R"({"popcut": 1, "svg_profiles": [{"name": "lab", "use": 3}]})");
  CHECK_FALSE(shop.daemon.start());
  CHECK(says(shop.daemon.log(), "svg_profiles.json: /svg_profiles/0"));
}

TEST_CASE("SIGHUP applies what does not disturb a cut and names the rest", "[popcutd][cli]") {
  Workshop shop;
  shop.open();
  const std::string id = shop.queue();
  REQUIRE(shop.comes_to(id, "ready"));
  const std::string faulty = shop.reloaded("rate_per_s = 0.0001\n");  // stands there twice now
  CHECK(says(faulty, "was not loaded; nothing has changed: "));
  CHECK(says(faulty, "popcutd.toml"));
  CHECK(faulty.find("configuration") == faulty.rfind("configuration"));
  write_file(shop.daemon.config(), "listen = [\"127.0.0.1:0\"]\nsocket = \"" +
                                       shop.daemon.socket() + "\"\nstate = \"" +
                                       shop.daemon.state() + "\"\n");
  const std::string taken = shop.reloaded(
      "[[device]]\nid = \"sim:cameo3\"\nmaterials = [\"pp-150\"]\ntime_scale = 7\n[limits]\n"
      "queue_jobs = 1\n[log]\nlevel = \"debug\"\n");
  CHECK(says(
      taken,
      "configuration reloaded: log.level, allowed_hosts, allowed_origins, user, limits, webhook"));
  CHECK(says(taken, "changed, but used only after a restart: "));
  CHECK(says(taken, "device sim:cameo3"));
  CHECK(shop.popcut({"cut", kUnit}).exit == 5);  // the queue holds one now
  const Ran arm = shop.popcut({"arm", id});
  CHECK(arm.exit == 5);
  CHECK(shop.popcut({"devices", "--json"}).out.find("pp-150") != std::string::npos);
  // A webhook without its secret's file: nothing of the whole is taken.
  const std::string hook = shop.reloaded(
      "[webhook]\nurl = \"http://localhost:9/\"\nsecret_file = \"/nonexistent\"\n"
      "allow = [\"localhost:9\"]\n");
  CHECK(says(hook, "was not loaded"));
  CHECK(says(hook, "webhook.secret_file"));
  const std::vector<std::string> checking{popcutd_program(), "--config", shop.daemon.config(),
                                          "--check-config"};
  const Ran bad = run_program(checking, shop.daemon.folder().path());
  CHECK(bad.exit == 78);
  CHECK(says(bad.err, "popcutd.toml: webhook.secret_file"));
  const std::string text = text_of_file(shop.daemon.config());
  write_file(shop.daemon.config(), text.substr(0, text.find("[webhook]")));
  const Ran check = run_program(checking, shop.daemon.folder().path());
  CHECK(check.exit == 0);
  CHECK(says(check.out, "SIGHUP reloads: log.level"));
}

}  // namespace popcutd_command_test
