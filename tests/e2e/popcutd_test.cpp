// SPDX-License-Identifier: MIT
// popcutd and popcut together, as people use them.
#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <future>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "tests/support/daemon_process.hpp"

using namespace popcut::testing;
using Json = nlohmann::json;
namespace fs = std::filesystem;

namespace {

const std::string kSphere = POPCUT_SOURCE_DIR "/examples/sphere.json";
const std::string kUnit = POPCUT_SOURCE_DIR "/examples/unit.json";

/// A daemon and people who talk with it.
struct Workshop {
  explicit Workshop(double time_scale = 0, const std::string& more = "")
      : daemon(POPCUTD_PROGRAM, time_scale, more) {
    ::setenv("POPCUT_URL", daemon.socket().c_str(), 1);
    ::unsetenv("POPCUT_TOKEN");
  }
  DaemonProcess daemon;

  void open() {
    const bool serves = daemon.start();
    INFO(daemon.log());
    REQUIRE(serves);
  }
  [[nodiscard]] Ran popcut(std::vector<std::string> words) const {
    words.insert(words.begin(), POPCUT_PROGRAM);
    return run_program(words, daemon.folder().path());
  }
  [[nodiscard]] Ran until_done(const std::vector<std::string>& words) const {
    const auto begun = std::chrono::steady_clock::now();
    for (;;) {
      Ran ran = popcut(words);
      if (ran.exit == 0 || std::chrono::steady_clock::now() - begun > std::chrono::seconds(60))
        return ran;
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
  }
  [[nodiscard]] Json job(const std::string& id) const {
    return Json::parse(popcut({"jobs", id, "--json"}).out);
  }
  [[nodiscard]] bool comes_to(const std::string& id, const std::string& state) const {
    const auto begun = std::chrono::steady_clock::now();
    while (job(id)["state"] != state) {
      if (std::chrono::steady_clock::now() - begun > std::chrono::seconds(60)) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    return true;
  }
  /// What the simulated knife did, newest sheet.
  [[nodiscard]] Json trace() const {
    fs::path newest;
    for (const auto& entry : fs::directory_iterator(daemon.folder() / "trace"))
      if (entry.path().extension() == ".json" && (newest.empty() || entry.path() > newest))
        newest = entry.path();
    return Json::parse(text_of_file(newest));
  }
};

/// Takes what a webhook sends: refuses the first, takes all others.
class Receiver {
 public:
  Receiver() : fd_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in at{};
    at.sin_family = AF_INET;
    at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof at;
    REQUIRE(::bind(fd_, reinterpret_cast<const sockaddr*>(&at), size) == 0);
    REQUIRE(::listen(fd_, 8) == 0);
    REQUIRE(::getsockname(fd_, reinterpret_cast<sockaddr*>(&at), &size) == 0);
    port_ = ntohs(at.sin_port);
    thread_ = std::thread([this] { serve(); });
  }
  ~Receiver() {
    end_ = true;
    thread_.join();
    ::close(fd_);
  }
  Receiver(const Receiver&) = delete;
  Receiver& operator=(const Receiver&) = delete;
  [[nodiscard]] std::string host_port() const { return "127.0.0.1:" + std::to_string(port_); }
  [[nodiscard]] std::vector<std::string> requests() {
    const std::lock_guard hold(lock_);
    return requests_;
  }

 private:
  void serve() {
    while (!end_) {
      pollfd one{fd_, POLLIN, 0};
      if (::poll(&one, 1, 50) > 0) answer(::accept(fd_, nullptr, nullptr));
    }
  }
  void answer(int peer) {
    std::string text;
    std::array<char, 4096> room{};
    while (!whole(text)) {
      pollfd one{peer, POLLIN, 0};
      if (::poll(&one, 1, 5000) <= 0) break;
      const ssize_t got = ::recv(peer, room.data(), room.size(), 0);
      if (got <= 0) break;
      text.append(room.data(), static_cast<std::size_t>(got));
    }
    const std::lock_guard hold(lock_);
    const std::string status = requests_.empty() ? "500 No" : "204 Taken";
    requests_.push_back(text);
    const std::string reply =
        "HTTP/1.1 " + status + "\r\nConnection: close\r\nContent-Length: 0\r\n\r\n";
    (void)::send(peer, reply.data(), reply.size(), MSG_NOSIGNAL);
    ::close(peer);
  }
  static bool whole(const std::string& text) {
    const std::size_t end = text.find("\r\n\r\n"), at = text.find("Content-Length: ");
    return end != std::string::npos && at != std::string::npos &&
           text.size() >= end + 4 + std::strtoul(text.c_str() + at + 16, nullptr, 10);
  }
  int fd_;
  std::uint16_t port_{};
  std::atomic<bool> end_{false};
  std::mutex lock_;
  std::vector<std::string> requests_;
  std::thread thread_;
};

std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

/// The stored program of sheet 1 does what the knife did, and what its drawing says.
void check_trace(const Workshop& shop, const std::string& job) {
  const std::string plan = shop.job(job)["plan"];
  const fs::path folder = fs::path(shop.daemon.state()) / "plans" / plan;
  const Ran ran =
      shop.popcut({"simulate", (folder / "sheet-01.gpgl").string(), "-o", "sim", "--machine",
                   "cameo3", "--expect", (folder / "sheet-01.svg").string()});
  INFO(ran.err);
  REQUIRE(ran.exit == 0);
  const Json planned = Json::parse(text_of_file(shop.daemon.folder() / "sim/trace.json"));
  const Json done = shop.trace();
  CHECK(done["strokes"] == planned["strokes"]);
  CHECK(done["lifts"] == planned["lifts"]);
  CHECK(done["strokes"].size() > 100);
}

}  // namespace

TEST_CASE("a job goes from a spec to a cut sheet by the commands of the manual", "[popcutd][e2e]") {
  Workshop shop;
  shop.open();
  auto waiting = std::async(std::launch::async, [&] {
    return shop.popcut({"cut", kSphere, "--wait"});
  });
  const auto begun = std::chrono::steady_clock::now();
  std::string list;
  while (list.find("-> load sheet 1 of 1: popcut arm") == std::string::npos &&
         std::chrono::steady_clock::now() - begun < std::chrono::seconds(60))
    list = shop.popcut({"jobs"}).out;
  const Ran arm = shop.popcut({"arm"});
  INFO(arm.err);
  REQUIRE(arm.exit == 0);
  CHECK(arm.err.find("popcut start") != std::string::npos);
  const Ran start = shop.popcut({"start"});
  INFO(start.err);
  REQUIRE(start.exit == 0);
  const Ran cut = waiting.get();
  INFO(cut.err);
  CHECK(cut.exit == 0);
  CHECK(cut.err.find("sphere: done") != std::string::npos);
  const std::string id = first_line(cut.out);
  CHECK(shop.job(id)["state"] == "done");
  check_trace(shop, id);
  const Ran shown = shop.popcut({"jobs", id.substr(0, 20)});
  CHECK(shown.out.find("sheet 1    done         378 paths") != std::string::npos);
  CHECK(shop.popcut({"usage"}).out.find(",1\r\n") != std::string::npos);
  CHECK(shop.popcut({"db", "check"}).out == "result: ok\n");
  shop.daemon.signal(SIGTERM);
  CHECK(shop.daemon.wait() == 0);
}

TEST_CASE("the same is done with curl alone and a token over TCP", "[popcutd][e2e]") {
  Workshop shop;
  shop.open();
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
  const Json token = curl({"--unix-socket", shop.daemon.socket(), "http://localhost/v1/tokens",
                           "-H", json, "-d", R"({"name": "curl", "role": "operator"})"});
  const std::string url = shop.daemon.url();
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
  check_trace(shop, job["id"]);
}

TEST_CASE("popcutd with nothing configured cuts for popcut with nothing configured",
          "[popcutd][e2e]") {
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
  const std::string folders = fs::path(POPCUT_PROGRAM).parent_path().string() + ":" +
                              fs::path(POPCUTD_PROGRAM).parent_path().string();
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

TEST_CASE("a stop while cutting ends with the stroke and the job says so", "[popcutd][e2e]") {
  Workshop shop(10);
  shop.open();
  const std::string id = first_line(shop.popcut({"cut", kSphere, "-q"}).out);
  REQUIRE(shop.until_done({"arm", id, "1"}).exit == 0);
  REQUIRE(shop.popcut({"start", id}).exit == 0);
  REQUIRE(shop.comes_to(id, "cutting"));
  std::this_thread::sleep_for(std::chrono::milliseconds(1500));
  shop.daemon.signal(SIGTERM);
  CHECK(shop.daemon.wait() == 0);
  shop.open();
  const Json job = shop.job(id);
  CHECK(job["state"] == "interrupted");
  CHECK(job["reason"] == "shutdown");
  const Ran list = shop.popcut({"jobs"});
  CHECK(list.out.find("popcut retry " + id.substr(0, 12) + " 1") != std::string::npos);
  CHECK(shop.popcut({"start", id}).exit == 5);
  REQUIRE(shop.popcut({"retry", id, "1"}).exit == 0);
  CHECK(shop.job(id)["blank"] == 2);
  CHECK(shop.popcut({"cancel", id, "--reason", "enough"}).exit == 0);
  CHECK(shop.job(id)["state"] == "cancelled");
}

TEST_CASE("the words of popcut plan and the files of a spec go along with a job",
          "[popcutd][e2e]") {
  Workshop shop;
  shop.open();
  // A grid that the spec names by its file goes up first.
  std::string grid;
  for (int row = 0; row < 12; ++row) {
    for (int column = 0; column < 12; ++column)
      grid += (column > 0 ? "," : "") + std::to_string(60.0 - 3.0 * column - 0.1 * row * row);
    grid += "\n";
  }
  write_file(shop.daemon.folder() / "heights.csv", grid);
  write_file(shop.daemon.folder() / "hill.json",
             R"({"popcut": 1, "name": "hill", "surface": {"type": "grid", "file": "heights.csv"},
                 "scale_mm": 1, "units_per_slice": 3, "slices": 4, "widths_mm": 2})");
  const Ran hill = shop.popcut({"cut", "hill.json"});
  CAPTURE(hill.err);
  CHECK(hill.exit == 0);
  CHECK(hill.err.find("uploading heights.csv") != std::string::npos);
  REQUIRE(fs::exists(shop.daemon.state() + "/assets"));
  CHECK(files_below(shop.daemon.state() + "/assets").size() == 1);
  write_file(shop.daemon.folder() / "lost.json",
             R"({"popcut": 1, "surface": {"type": "grid", "file": "absent.csv"},
                 "units_per_slice": 3, "slices": 4, "widths_mm": 2})");
  const Ran lost = shop.popcut({"cut", "lost.json"});
  CHECK(lost.exit == 3);
  CHECK(lost.err.find("lost.json: /surface/file: absent.csv") != std::string::npos);

  const std::string id = first_line(
      shop.popcut({"cut", kUnit, "-q", "--order", "keep", "--material", "pp-150", "--copies", "3"})
          .out);
  REQUIRE(shop.comes_to(id, "ready"));
  CHECK(shop.job(id)["sheets_total"] == 3);
  CHECK(shop.job(id)["material"] == "pp-150");
  const Ran wrong = shop.popcut({"cut", kUnit, "--material", "pp-15"});
  CHECK(wrong.exit == 2);
  CHECK(wrong.err.find("--material") != std::string::npos);
  CHECK(shop.popcut({"cut", POPCUT_SOURCE_DIR "/README.md"}).exit == 3);
}

TEST_CASE("the view of jobs has all of them and each change", "[popcutd][e2e]") {
  Workshop shop;
  shop.open();
  const std::string one = first_line(shop.popcut({"cut", kUnit, "-q"}).out);
  const std::string two = first_line(shop.popcut({"cut", kUnit, "-q", "--name", "gift card"}).out);
  REQUIRE(shop.comes_to(one, "ready"));
  REQUIRE(shop.comes_to(two, "ready"));
  CHECK(shop.popcut({"arm"}).exit == 2);  // which of the two?
  CHECK(shop.popcut({"arm", one.substr(0, 4)}).exit == 2);
  auto view = std::async(std::launch::async, [&] {
    return run_program(
        {"/usr/bin/env", "timeout", "-s", "INT", "3", POPCUT_PROGRAM, "jobs", "--watch"}, "/");
  });
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  REQUIRE(shop.popcut({"cancel", two, "-q"}).exit == 0);
  const std::string shown = view.get().out;
  CAPTURE(shown);
  CHECK(shown.find(one.substr(0, 12) + " unit: ready") != std::string::npos);
  CHECK(shown.find(two.substr(0, 12) + " gift card: ready") != std::string::npos);
  CHECK(shown.find(two.substr(0, 12) + " gift card: cancelled") != std::string::npos);
  CHECK(shop.popcut({"jobs", "--state", "cancelled"}).out.find("gift card") != std::string::npos);
  CHECK(shop.popcut({"hold", one}).exit == 0);
  CHECK(shop.popcut({"jobs"}).out.find("held") != std::string::npos);
  CHECK(shop.popcut({"release", one}).exit == 0);
  CHECK(shop.popcut({"pause", one}).exit == 5);
  CHECK(shop.popcut({"events", "--job", one, "--json"}).out.find("\"planning\"") !=
        std::string::npos);
}

TEST_CASE("a second popcutd on the same state says who holds it", "[popcutd][e2e]") {
  Workshop shop;
  shop.open();
  const Ran second =
      run_program({POPCUTD_PROGRAM, "--state", shop.daemon.state(), "--listen", "127.0.0.1:0",
                   "--socket", (shop.daemon.folder() / "other.sock").string()},
                  "/");
  CAPTURE(second.err);
  CHECK(second.exit == 5);
  CHECK(second.err.find(std::to_string(shop.daemon.pid())) != std::string::npos);
  const Ran third = run_program(
      {POPCUTD_PROGRAM, "--state", (shop.daemon.folder() / "third").string(), "--listen",
       shop.daemon.url().substr(7), "--socket", (shop.daemon.folder() / "third.sock").string()},
      "/");
  CAPTURE(third.err);
  CHECK(third.exit == 5);
  CHECK(third.err.find(shop.daemon.url().substr(7)) != std::string::npos);
}

TEST_CASE("what needs a person ends popcutd with 78", "[popcutd][e2e]") {
  Workshop shop;
  shop.open();
  shop.daemon.signal(SIGTERM);
  REQUIRE(shop.daemon.wait() == 0);
  const std::string database = shop.daemon.state() + "/popcut.db";
  std::string bytes = text_of_file(database);
  for (std::size_t at = bytes.size() - 4096; at < bytes.size(); at += 4) bytes[at] = '\x55';
  write_file(database, bytes);
  const Ran damaged = run_program({POPCUTD_PROGRAM, "--config", shop.daemon.config()}, "/");
  CAPTURE(damaged.err);
  CHECK(damaged.exit == 78);
  CHECK(damaged.err.find("salvage") != std::string::npos);
  const Ran salvage = shop.popcut({"db", "salvage", "--state", shop.daemon.state()});
  CAPTURE(salvage.err);
  CHECK(salvage.exit == 0);
  shop.open();

  const std::string wrong = (shop.daemon.folder() / "wrong.toml").string();
  write_file(wrong, "[limits]\njson_dept = 3\n");
  const Ran config = run_program({POPCUTD_PROGRAM, "--config", wrong, "--check-config"}, "/");
  CHECK(config.exit == 78);
  CHECK(config.err == "popcutd: " + wrong +
                          ": 2:1: limits.json_dept: is not a key that popcutd knows; did you mean "
                          "json_depth?\n");
  CHECK(run_program({POPCUTD_PROGRAM, "--config", shop.daemon.config(), "--check-config"}, "/")
            .exit == 0);
  CHECK(run_program({POPCUTD_PROGRAM, "--frobnicate"}, "/").exit == 2);
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"--sim", "nope"}, {"--listen", "x"}, {"--state", wrong}}) {
    const Ran line =
        run_program({POPCUTD_PROGRAM, "--config", shop.daemon.config(), words[0], words[1]}, "/");
    CHECK(line.exit == 2);
    CHECK(line.err.rfind("popcutd: " + words[0] + ": ", 0) == 0);
  }
  const std::string other = (shop.daemon.folder() / "other").string();
  const Ran taken = run_program(
      {POPCUTD_PROGRAM, "--state", other, "--listen", "127.0.0.1:0", "--socket", wrong}, "/");
  CHECK(taken.exit == 5);
  CHECK(taken.err.find("is no socket") != std::string::npos);
  CHECK(text_of_file(wrong) == "[limits]\njson_dept = 3\n");
  CHECK(run_program({POPCUTD_PROGRAM, "--print-config"}, "/").out.find("#json_depth = 32") !=
        std::string::npos);
}

TEST_CASE("the service manager is told of each step and fed while all turns", "[popcutd][e2e]") {
  Workshop shop;
  const std::string path = (shop.daemon.folder() / "notify").string();
  const int listener = ::socket(AF_UNIX, SOCK_DGRAM, 0);
  sockaddr_un at{};
  at.sun_family = AF_UNIX;
  path.copy(at.sun_path, path.size());
  REQUIRE(::bind(listener, reinterpret_cast<const sockaddr*>(&at), sizeof at) == 0);
  const bool serves = shop.daemon.start({"NOTIFY_SOCKET=" + path, "WATCHDOG_USEC=1000000"});
  INFO(shop.daemon.log());
  REQUIRE(serves);
  std::string heard;
  const auto listen_for = [&](const std::string& word) {
    const auto begun = std::chrono::steady_clock::now();
    while (std::chrono::steady_clock::now() - begun < std::chrono::seconds(30)) {
      std::array<char, 512> room{};
      const ssize_t got = ::recv(listener, room.data(), room.size(), MSG_DONTWAIT);
      if (got > 0) heard += std::string(room.data(), static_cast<std::size_t>(got)) + "\n";
      if (heard.find(word) != std::string::npos) return true;
      if (got <= 0) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return false;
  };
  CHECK(listen_for("READY=1"));
  CHECK(listen_for("WATCHDOG=1"));
  CHECK(listen_for("STATUS=waiting for jobs"));
  shop.daemon.signal(SIGHUP);
  CHECK(listen_for("RELOADING=1"));
  heard.clear();
  CHECK(listen_for("READY=1"));
  shop.daemon.signal(SIGTERM);
  CHECK(listen_for("STOPPING=1"));
  CHECK(shop.daemon.wait() == 0);
  ::close(listener);
}

TEST_CASE("a webhook hears each event in order and again until it has taken it", "[popcutd][e2e]") {
  Receiver receiver;
  const TempFolder folder;
  const std::string secret = (folder / "secret").string();
  write_file(secret, "0123456789abcdef\n");
  Workshop shop(0, "[webhook]\nurl = \"http://" + receiver.host_port() + "/hook\"\nallow = [\"" +
                       receiver.host_port() + "\"]\nsecret_file = \"" + secret + "\"\n");
  shop.open();
  const std::string id = first_line(shop.popcut({"cut", kUnit, "-q"}).out);
  REQUIRE(shop.comes_to(id, "ready"));
  REQUIRE(shop.popcut({"cancel", id}).exit == 0);
  const auto begun = std::chrono::steady_clock::now();
  std::vector<std::string> requests;
  const auto told = [&](const std::string& word) {
    requests = receiver.requests();
    return !requests.empty() && requests.back().find(word) != std::string::npos;
  };
  while (!told("cancelled") && std::chrono::steady_clock::now() - begun < std::chrono::seconds(60))
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  REQUIRE(told("cancelled"));
  REQUIRE(requests.size() > 4);
  const auto body = [](const std::string& text) { return text.substr(text.find("\r\n\r\n") + 4); };
  CHECK(body(requests[0]) == body(requests[1]));  // refused, and sent again
  std::int64_t last = 0;
  for (std::size_t k = 1; k < requests.size(); ++k) {
    CHECK(requests[k].rfind("POST /hook HTTP/1.1\r\n", 0) == 0);
    CHECK(requests[k].find("\r\nPopcut-Signature: sha256=") != std::string::npos);
    const std::int64_t seq = Json::parse(body(requests[k]))["seq"];
    CHECK(seq > last);
    last = seq;
  }
  shop.daemon.signal(SIGTERM);
  CHECK(shop.daemon.wait() == 0);
  CHECK(text_of_file(fs::path(shop.daemon.state()) / "webhook") == std::to_string(last));
}

TEST_CASE("sockets of systemd are served and no others", "[popcutd][e2e]") {
  if (run_program({"/usr/bin/env", "systemd-socket-activate", "--version"}, "/").exit != 0) {
    WARN("skipped: there is no systemd-socket-activate here");
    return;
  }
  Workshop shop;
  const std::string socket = (shop.daemon.folder() / "activated.sock").string();
  const std::string script = "systemd-socket-activate -l '" + socket +
                             "' " POPCUTD_PROGRAM " --config '" + shop.daemon.config() +
                             "' 2>activated.log & daemon=$!\n"
                             "for k in $(seq 300); do [ -S '" +
                             socket +
                             "' ] && break; sleep 0.1; done\n"
                             "POPCUT_URL='" +
                             socket +
                             "' " POPCUT_PROGRAM
                             " jobs -q; result=$?\n"
                             "kill $daemon; wait $daemon\nexit $result\n";
  const Ran ran = run_program({"/bin/bash", "-c", script}, shop.daemon.folder().path());
  INFO(ran.err << text_of_file(shop.daemon.folder() / "activated.log"));
  CHECK(ran.exit == 0);
  CHECK_FALSE(fs::exists(shop.daemon.socket()));
}
