// SPDX-License-Identifier: MIT
// popcutd as a service: its start and end, what it tells systemd, its webhook.
#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "tests/support/daemon_with_cli.hpp"
#include "tests/support/paths.hpp"

namespace popcutd_service_test {

using namespace popcut::testing;
using Json = nlohmann::json;
namespace fs = std::filesystem;

namespace {

const std::string kUnit = source_file("examples/unit.json");

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

}  // namespace

TEST_CASE("a second popcutd on the same state reports the first one", "[popcutd][e2e]") {
  DaemonWithCli lab;
  lab.open();
  const Ran second =
      run_program({popcutd_program(), "--state", lab.daemon.state(), "--listen", "127.0.0.1:0",
                   "--socket", (lab.daemon.folder() / "other.sock").string()},
                  "/");
  CAPTURE(second.err);
  CHECK(second.exit == 5);
  CHECK(second.err.find(std::to_string(lab.daemon.pid())) != std::string::npos);
  const Ran third = run_program(
      {popcutd_program(), "--state", (lab.daemon.folder() / "third").string(), "--listen",
       lab.daemon.url().substr(7), "--socket", (lab.daemon.folder() / "third.sock").string()},
      "/");
  CAPTURE(third.err);
  CHECK(third.exit == 5);
  CHECK(third.err.find(lab.daemon.url().substr(7)) != std::string::npos);
}

TEST_CASE("a fault that needs a person ends popcutd with exit code 78", "[popcutd][e2e][alone]") {
  DaemonWithCli lab;
  lab.open();
  lab.daemon.signal(SIGTERM);
  REQUIRE(lab.daemon.wait() == 0);
  const std::string database = lab.daemon.state() + "/popcut.db";
  std::string bytes = text_of_file(database);
  for (std::size_t at = bytes.size() - 4096; at < bytes.size(); at += 4) bytes[at] = '\x55';
  write_file(database, bytes);
  const Ran damaged = run_program({popcutd_program(), "--config", lab.daemon.config()}, "/");
  CAPTURE(damaged.err);
  CHECK(damaged.exit == 78);
  CHECK(damaged.err.find("salvage") != std::string::npos);
  const Ran salvage = lab.popcut({"db", "salvage", "--state", lab.daemon.state()});
  CAPTURE(salvage.err);
  CHECK(salvage.exit == 0);
  lab.open();

  const std::string wrong = (lab.daemon.folder() / "wrong.toml").string();
  write_file(wrong, "[limits]\njson_dept = 3\n");
  const Ran config = run_program({popcutd_program(), "--config", wrong, "--check-config"}, "/");
  CHECK(config.exit == 78);
  CHECK(config.err == "popcutd: " + wrong +
                          ": 2:1: limits.json_dept: is not known; did you mean "
                          "json_depth?\n");
  CHECK(run_program({popcutd_program(), "--config", lab.daemon.config(), "--check-config"}, "/")
            .exit == 0);
  CHECK(run_program({popcutd_program(), "--frobnicate"}, "/").exit == 2);
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"--sim", "nope"}, {"--listen", "x"}, {"--state", wrong}}) {
    const Ran line =
        run_program({popcutd_program(), "--config", lab.daemon.config(), words[0], words[1]}, "/");
    CHECK(line.exit == 2);
    CHECK(line.err.rfind("popcutd: " + words[0] + ": ", 0) == 0);
  }
  const std::string other = (lab.daemon.folder() / "other").string();
  const Ran taken = run_program(
      {popcutd_program(), "--state", other, "--listen", "127.0.0.1:0", "--socket", wrong}, "/");
  CHECK(taken.exit == 5);
  CHECK(taken.err.find("is not a socket") != std::string::npos);
  CHECK(text_of_file(wrong) == "[limits]\njson_dept = 3\n");
  CHECK(run_program({popcutd_program(), "--print-config"}, "/").out.find("#json_depth = 32") !=
        std::string::npos);
}

TEST_CASE(
    "an older copy that was put back by hand is refused with the command that goes back to it",
    "[popcutd][e2e][alone]") {
  DaemonWithCli lab;
  lab.open();
  REQUIRE(lab.popcut({"cut", "-q", kUnit}).exit == 0);
  const Ran backup = lab.popcut({"db", "backup", "--json"});
  CAPTURE(backup.err);
  REQUIRE(backup.exit == 0);
  const std::string copy = Json::parse(backup.out)["path"];
  REQUIRE(lab.popcut({"cut", "-q", kUnit}).exit == 0);
  lab.daemon.signal(SIGTERM);
  REQUIRE(lab.daemon.wait() == 0);
  const fs::path state = lab.daemon.state();
  fs::copy_file(copy, state / "popcut.db", fs::copy_options::overwrite_existing);
  fs::remove(state / "popcut.db-wal");
  fs::remove(state / "database-state");
  const Ran refused = run_program({popcutd_program(), "--config", lab.daemon.config()}, "/");
  CAPTURE(refused.err);
  CHECK(refused.exit == 78);
  CHECK(says(refused.err, "'popcut db restore COPY --older --state " + state.string() + "'"));
  const Ran restored = lab.popcut({"db", "restore", copy, "--older", "--state", state.string()});
  CAPTURE(restored.err);
  CHECK(restored.exit == 0);
  lab.open();
  CHECK(Json::parse(lab.popcut({"jobs", "--all", "--json"}).out)["jobs"].size() == 1);
}

TEST_CASE("the help of popcutd has no two empty lines in a row", "[popcutd][e2e]") {
  const Ran help = run_program({popcutd_program(), "--help"}, "/");
  CHECK(help.exit == 0);
  CHECK(says(help.out, "\n\nExit codes: "));
  CHECK_FALSE(says(help.out, "\n\n\n"));
}

TEST_CASE("too few descriptors for the connections are raised or reported", "[popcutd][e2e]") {
  rlimit before{};
  REQUIRE(::getrlimit(RLIMIT_NOFILE, &before) == 0);
  const auto started_with = [&](rlim_t soft, rlim_t hard) {
    DaemonProcess daemon(popcutd_program());
    const rlimit few{soft, hard};
    REQUIRE(::setrlimit(RLIMIT_NOFILE, &few) == 0);
    const bool serves = daemon.start();
    rlimit now{};
    const bool seen = ::prlimit(daemon.pid(), RLIMIT_NOFILE, nullptr, &now) == 0;
    ::setrlimit(RLIMIT_NOFILE, &before);  // a hard limit stays as low unless root runs this
    REQUIRE((serves && seen));
    return std::pair(now.rlim_cur, daemon.log());
  };
  const auto [raised, quiet] = started_with(90, before.rlim_max);
  CHECK(raised == 64 + 4 + 40 + 24);
  CHECK(quiet.find("may open") == std::string::npos);
  const auto [low, told] = started_with(90, 100);
  CHECK(low == 100);
  INFO(told);
  CHECK(told.find("may open 100 files, which is enough for about 36 clients, not for "
                  "limits.connections = 64; raise the limit to 132") != std::string::npos);
}

TEST_CASE("the service manager is notified of each step and the watchdog is fed",
          "[popcutd][e2e]") {
  DaemonWithCli lab;
  const std::string path = (lab.daemon.folder() / "notify").string();
  const int listener = ::socket(AF_UNIX, SOCK_DGRAM, 0);
  sockaddr_un at{};
  at.sun_family = AF_UNIX;
  path.copy(at.sun_path, path.size());
  REQUIRE(::bind(listener, reinterpret_cast<const sockaddr*>(&at), sizeof at) == 0);
  const bool serves = lab.daemon.start({"NOTIFY_SOCKET=" + path, "WATCHDOG_USEC=1000000"});
  INFO(lab.daemon.log());
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
  lab.daemon.signal(SIGHUP);
  CHECK(listen_for("RELOADING=1"));
  heard.clear();
  CHECK(listen_for("READY=1"));
  lab.daemon.signal(SIGTERM);
  CHECK(listen_for("STOPPING=1"));
  CHECK(lab.daemon.wait() == 0);
  ::close(listener);
}

TEST_CASE("a webhook gets each event in order and repeated until it accepts", "[popcutd][e2e]") {
  Receiver receiver;
  const TempFolder folder;
  const std::string secret = (folder / "secret").string();
  write_file(secret, "0123456789abcdef\n");
  DaemonWithCli lab(0, "[webhook]\nurl = \"http://" + receiver.host_port() +
                           "/hook\"\nallow = [\"" + receiver.host_port() + "\"]\nsecret_file = \"" +
                           secret + "\"\n");
  lab.open();
  const std::string id = first_line(lab.popcut({"cut", kUnit, "-q"}).out);
  REQUIRE(lab.comes_to(id, "ready"));
  REQUIRE(lab.popcut({"cancel", id}).exit == 0);
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
  // It was heard; that popcutd has our answer too shows in what it notes.
  const fs::path cursor = fs::path(lab.daemon.state()) / "webhook";
  while (text_of_file(cursor) != std::to_string(last) &&
         std::chrono::steady_clock::now() - begun < std::chrono::seconds(120))
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  lab.daemon.signal(SIGTERM);
  CHECK(lab.daemon.wait() == 0);
  CHECK(text_of_file(cursor) == std::to_string(last));
}

TEST_CASE("sockets of systemd are served and no others", "[popcutd][e2e]") {
  if (run_program({"/usr/bin/env", "systemd-socket-activate", "--version"}, "/").exit != 0) {
    WARN("skipped: there is no systemd-socket-activate here");
    return;
  }
  DaemonWithCli lab;
  const std::string socket = (lab.daemon.folder() / "activated.sock").string();
  const std::string script = "systemd-socket-activate -l '" + socket + "' " +
                             std::string(popcutd_program()) + " --config '" + lab.daemon.config() +
                             "' 2>activated.log & daemon=$!\n"
                             "for k in $(seq 600); do POPCUT_URL='" +
                             socket + "' " + std::string(popcut_program()) +
                             " jobs -q; result=$?\n"
                             "[ $result = 0 ] && break; sleep 0.1; done\n"
                             "kill $daemon; wait $daemon\nexit $result\n";
  const Ran ran = run_program({"/bin/bash", "-c", script}, lab.daemon.folder().path());
  INFO(ran.err << text_of_file(lab.daemon.folder() / "activated.log"));
  CHECK(ran.exit == 0);
  CHECK_FALSE(fs::exists(lab.daemon.socket()));
}

}  // namespace popcutd_service_test
