// SPDX-License-Identifier: MIT
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <string>

#include <catch2/catch.hpp>

#include "daemon/popcutd/log.hpp"
#include "daemon/popcutd/options.hpp"
#include "daemon/popcutd/paths.hpp"
#include "daemon/popcutd/pulse.hpp"
#include "daemon/popcutd/resources.hpp"
#include "daemon/popcutd/service_manager.hpp"
#include "daemon/popcutd/turn_away.hpp"
#include "daemon/popcutd/webhook.hpp"
#include "tests/support/process.hpp"
#include "tests/support/raw_http.hpp"

namespace popcutd_parts_test {

using namespace popcut;
using namespace popcut::daemon;

namespace {

client::Environment environment(std::map<std::string, std::string> values) {
  return [values = std::move(values)](const char* name) -> const char* {
    const auto found = values.find(name);
    return found == values.end() ? nullptr : found->second.c_str();
  };
}

/// The other end of NOTIFY_SOCKET.
class Listener {
 public:
  explicit Listener(const std::string& path) : fd_(::socket(AF_UNIX, SOCK_DGRAM, 0)) {
    sockaddr_un at{};
    at.sun_family = AF_UNIX;
    path.copy(at.sun_path, path.size());
    REQUIRE(::bind(fd_, reinterpret_cast<const sockaddr*>(&at), sizeof at) == 0);
  }
  ~Listener() { ::close(fd_); }
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;
  [[nodiscard]] std::string heard() const {
    std::array<char, 256> room{};
    const ssize_t got = ::recv(fd_, room.data(), room.size(), MSG_DONTWAIT);
    return got > 0 ? std::string(room.data(), static_cast<std::size_t>(got)) : std::string();
  }

 private:
  int fd_;
};

}  // namespace

TEST_CASE("popcutd's folders depend on the user who runs it", "[daemon][paths]") {
  const auto user =
      default_paths(environment({{"HOME", "/home/a"}, {"XDG_RUNTIME_DIR", "/run/user/7"}}), false);
  REQUIRE(user);
  CHECK(user->state == "/home/a/.local/state/popcut");
  CHECK(user->socket == "/run/user/7/popcut.sock");
  CHECK(user->configurations == std::vector<std::string>{"/home/a/.config/popcut/popcutd.toml",
                                                         "/etc/popcut/popcutd.toml"});
  const auto service =
      default_paths(environment({{"STATE_DIRECTORY", "/var/lib/popcut:/var/lib/other"},
                                 {"CONFIGURATION_DIRECTORY", "/etc/popcut"},
                                 {"HOME", "/"}}),
                    false);
  REQUIRE(service);
  CHECK(service->state == "/var/lib/popcut");
  CHECK(service->socket == "/run/popcut.sock");
  CHECK(service->configurations == std::vector<std::string>{"/etc/popcut/popcutd.toml"});
  CHECK(default_paths(environment({{"HOME", "/root"}}), true)->socket == "/run/popcut.sock");
  CHECK(default_paths(environment({{"HOME", "/h"}}), false)->socket ==
        "/h/.local/state/popcut/popcut.sock");
  const auto nowhere = default_paths(environment({}), false);
  REQUIRE_FALSE(nowhere);
  CHECK(nowhere.error().place == "--state");
}

TEST_CASE("popcutd notifies the service manager", "[daemon][systemd]") {
  const testing::TempFolder folder;
  const std::string path = (folder / "notify").string();
  const Listener listener(path);
  ::setenv("NOTIFY_SOCKET", path.c_str(), 1);
  ::setenv("WATCHDOG_USEC", "20000000", 1);
  const ServiceManager manager = ServiceManager::from_environment();
  CHECK(std::getenv("NOTIFY_SOCKET") == nullptr);
  CHECK(manager.present());
  CHECK(manager.watchdog_s() == 20.0);
  CHECK(manager.tell("READY=1"));
  CHECK(listener.heard() == "READY=1");
  CHECK(manager.tell_status("cutting\nEXTEND_TIMEOUT_USEC=9"));
  CHECK(listener.heard() == "STATUS=cutting EXTEND_TIMEOUT_USEC=9");
  const ServiceManager alone = ServiceManager::from_environment();
  CHECK_FALSE(alone.present());
  CHECK(alone.tell("READY=1"));
  CHECK_FALSE(alone.watchdog_s());
}

TEST_CASE("the service's thread is alive also if its cutters cannot be listed",
          "[daemon][systemd]") {
  ServiceForHttp http;
  Pulse pulse;
  const auto beat = [&] {
    pulse.ask(http.bench.thread(), http.service());
    http.ask([](LiveService&) {});
  };
  http.devices().fault = [] { throw std::bad_alloc(); };
  beat();
  http.devices().fault = {};
  CHECK(pulse.status().empty());
  beat();  // the one before was answered
  CHECK(pulse.status() == "waiting for jobs");
  CHECK(pulse.alive(600));
  const std::string job = http.bench.ready_job().id;
  http.bench.started(job);
  http.bench.cutters.set_state(http.bench.device, "idle");  // tells the service to look at them
  beat();
  CHECK(pulse.status() == "sim:cameo3 is cutting job " + job);
}

TEST_CASE("sockets for another process are not used", "[daemon][systemd]") {
  ::setenv("WATCHDOG_USEC", "1000000", 1);
  ::setenv("WATCHDOG_PID", "1", 1);
  ::setenv("LISTEN_FDS", "1", 1);
  ::setenv("LISTEN_PID", "1", 1);
  const ServiceManager manager = ServiceManager::from_environment();
  CHECK_FALSE(manager.watchdog_s());
  CHECK(manager.sockets().empty());
}

TEST_CASE("a log line is one line whatever it holds", "[daemon][log]") {
  CHECK(without_control("a\nb\x1b[31m\x07") == "a | b\\x1b[31m\\x07");
  CHECK(without_control("\xc2\x9b"
                        "31m caf\xc3\xa9") == "\\u009b31m caf\xc3\xa9");
  CHECK(without_control("a\xe2\x80\xae"
                        "b\xe2\x81\xa6\xe2\x80\x99\xe2\x80") ==
        "a\\u202eb\\u2066\xe2\x80\x99\xe2\x80");
  CHECK(json_string("a\"\n\xff") == "\"a\\\"\\n\xEF\xBF\xBD\"");
  CHECK(job_in("job 01JDX7KQ4M8ZB1Q2R3S4T5V6W7: cutting") == "01JDX7KQ4M8ZB1Q2R3S4T5V6W7");
  CHECK(job_in("job name is long and no id").empty());
  CHECK(job_in("job 01JDX7KQ4M8ZB1Q2R3S4T5V6W7X").empty());
}

TEST_CASE("a change of a job is logged with its id and reason", "[daemon][log]") {
  Event event{7, "job", 0, "01JDX7KQ4M8ZB1Q2R3S4T5V6W7",
              R"({"seq":7,"state":"interrupted","rev":4,"reason":"device_gone","sheet":2,)"
              R"("sheets_total":3})"};
  CHECK(change_line(event) ==
        "job 01JDX7KQ4M8ZB1Q2R3S4T5V6W7: interrupted, device_gone, sheet 2 of 3");
  CHECK(job_in(change_line(event)) == event.job);
  event.data = "no json";
  CHECK(change_line(event).empty());
  event = {0, "progress", 0, event.job, R"({"state":"cutting"})"};
  CHECK(change_line(event).empty());
}

TEST_CASE("clients waiting at a socket get the reason why popcutd does not start",
          "[daemon][systemd]") {
  const testing::TempFolder folder;
  const int listening = ::socket(AF_UNIX, SOCK_STREAM, 0);
  sockaddr_un at{};
  at.sun_family = AF_UNIX;
  (folder / "s").string().copy(at.sun_path, sizeof at.sun_path - 1);
  const auto* const address = reinterpret_cast<const sockaddr*>(&at);
  REQUIRE(::bind(listening, address, sizeof at) == 0);
  REQUIRE(::listen(listening, 8) == 0);
  std::array<int, 3> callers{};
  for (int& caller : callers) {
    caller = ::socket(AF_UNIX, SOCK_STREAM, 0);
    REQUIRE(::connect(caller, address, sizeof at) == 0);
  }
  const std::string request = "GET /v1/jobs HTTP/1.1\r\nHost: localhost\r\n\r\n";
  REQUIRE(::send(callers[0], request.data(), request.size(), 0) > 0);
  ::shutdown(callers[1], SHUT_RDWR);  // went away
  turn_away({listening}, "popcut.db: is \"damaged\"");
  for (const int caller : {callers[0], callers[2]}) {
    std::string answer(4096, ' ');
    const ssize_t size = ::recv(caller, answer.data(), answer.size(), 0);
    REQUIRE(size > 0);
    answer.resize(static_cast<std::size_t>(size));
    CHECK(answer.find("HTTP/1.1 503 ") == 0);
    CHECK(answer.find(R"(popcutd cannot start: popcut.db: is \"damaged\")") != std::string::npos);
  }
  for (const int caller : callers) ::close(caller);
  CHECK(::accept4(listening, nullptr, nullptr, SOCK_NONBLOCK) < 0);
  ::close(listening);
}

TEST_CASE("options override the configuration and both override the defaults", "[daemon][config]") {
  const testing::TempFolder folder;
  const std::string file = (folder / "popcutd.toml").string();
  testing::write_file(file,
                      "socket = \"/a.sock\"\nstate = \"/a\"\n[[device]]\nid = \"sim:cameo\"\n");
  DaemonOptions options;
  options.config = file;
  options.state = "/b";
  options.simulated = {"cameo4"};
  std::string found;
  const auto config = load_config(options, found);
  REQUIRE(config);
  CHECK(found == file);
  CHECK(config->state == "/b");
  CHECK(config->socket == "/a.sock");
  REQUIRE(config->devices.size() == 2);
  CHECK(config->devices[1].id == "sim:cameo4");
  options.simulated = {"cameo33"};
  const auto unknown = load_config(options, found);
  REQUIRE_FALSE(unknown);
  CHECK(message(unknown.error()).find("did you mean cameo3?") != std::string::npos);
  CHECK(unknown.error().place == "--sim");
  CHECK(unknown.error().kind == ErrorKind::Usage);
  options.simulated = {"cameo"};
  CHECK(message(load_config(options, found).error()).find("is attached already") !=
        std::string::npos);
  options.simulated.clear();
  options.listen = {"0.0.0.0:1"};
  CHECK(message(load_config(options, found).error()).rfind("--listen: ", 0) == 0);
  options.listen.clear();
  options.state = file;
  CHECK(message(load_config(options, found).error()).rfind("--state: " + file + " is a file", 0) ==
        0);
  testing::write_file(file, "state = 7\n");
  const auto wrong = load_config({.config = file}, found);
  REQUIRE_FALSE(wrong);
  CHECK(wrong.error().place == file + ": 1:9: state");
}

TEST_CASE("machines and materials of a configured device must exist", "[daemon][config]") {
  const testing::TempFolder folder;
  const std::string file = (folder / "popcutd.toml").string();
  const auto told = [&](const std::string& line) {
    testing::write_file(file, "state = \"/a\"\n[[device]]\nid = \"sim:cameo3\"\n" + line);
    std::string found;
    const auto config = load_config({.config = file}, found);
    if (!config) CHECK(config.error().kind != ErrorKind::Usage);
    return config ? std::string() : message(config.error());
  };
  const std::string device = file + ": device sim:cameo3: ";
  CHECK(told("materials = [\"paper-220\"]\n").empty());
  CHECK(told("materials = [\"paper-221\"]\n").rfind(device + "materials: ", 0) == 0);
  CHECK(told("treat_as = \"cameo33\"\n").rfind(device + "treat_as: ", 0) == 0);
  const std::string script = (folder / "faults.json").string();
  const std::string faults = "faults = \"" + script + "\"\n";
  CHECK(told(faults).rfind(device + "faults: " + script + ": cannot be read", 0) == 0);
  testing::write_file(script, "no JSON");
  CHECK(told(faults).rfind(device + "faults: " + script + ": ", 0) == 0);
  testing::write_file(script, R"({"popcut": 1, "faults": []})");
  CHECK(told(faults).empty());
}

TEST_CASE("an option that names nothing is refused", "[daemon][config]") {
  const std::string longest(108, 's');
  for (const auto& [option, value] : {std::pair{"--state", ""},
                                      {"--socket", ""},
                                      {"--config", ""},
                                      {"--sim", ""},
                                      {"--socket", longest.c_str()}}) {
    const char* const words[] = {"popcutd", option, value};
    const auto options = parse_options(3, words);
    REQUIRE_FALSE(options);
    CHECK(options.error().kind == ErrorKind::Usage);
    CHECK(options.error().place == option);
  }
}

TEST_CASE("workers get less memory than the control group and one of their own if it is delegated",
          "[daemon][resources]") {
  const testing::TempFolder folder;
  const std::string group = folder.path();
  const auto put = [&](const char* name, const std::string& text) {
    std::filesystem::create_directories((folder / name).parent_path());
    testing::write_file(folder / name, text);
  };
  constexpr std::uint64_t kMib = 1u << 20;
  put("memory.high", "1073741824\n");
  put("memory.max", "max\n");
  put("cgroup.procs", "1\n");
  CHECK(memory_for_workers(0, group)->bytes() == 768 * kMib);
  CHECK(memory_for_workers(100 * kMib, group)->bytes() == 100 * kMib);
  CHECK(memory_for_workers(0, "")->bytes() > 0);
  CHECK(memory_for_workers(0, group)->group() < 0);  // it is not that of popcutd alone
  const std::string self = std::to_string(::getpid());
  put("cgroup.procs", self + "\n");
  CHECK(memory_for_workers(0, group)->group() < 0);  // it is not delegated
  for (const char* name : {"cgroup.subtree_control", "main/cgroup.procs", "workers/memory.max",
                           "workers/cgroup.procs"})
    put(name, "");
  CHECK(memory_for_workers(0, group)->group() >= 0);
  CHECK(testing::text_of_file(folder / "main/cgroup.procs") == self);
  CHECK(testing::text_of_file(folder / "cgroup.subtree_control") == "+memory");
  CHECK(testing::text_of_file(folder / "workers/memory.max") == std::to_string(768 * kMib));
}

TEST_CASE("a webhook calls only allowed addresses and signs its requests", "[daemon][webhook]") {
  const testing::TempFolder folder;
  const std::string secret = (folder / "secret").string();
  testing::write_file(secret, "0123456789abcdef0123456789abcdef\n");
  WebhookConfig config{"http://localhost:9000/popcut?a=b", secret, {"localhost:9000"}};
  const auto target = webhook_target(config);
  REQUIRE(target);
  CHECK(target->host_port == "localhost:9000");
  CHECK(target->path == "/popcut?a=b");
  CHECK(target->secret == "0123456789abcdef0123456789abcdef");
  // As Python's hmac.new(b"key", b"1763719200.{}", "sha256") has it.
  CHECK(webhook_signature("key", "", "x") != webhook_signature("key", "1", "x"));
  CHECK(webhook_signature("key", "1763719200", "{}") ==
        "sha256=0dff72a09a4152725872582c6a301b3f26cbdef6ccd2e061d1fffa4642e2b892");
  config.allow = {"localhost:9001"};
  CHECK(webhook_target(config).error().detail.find("webhook.allow") != std::string::npos);
  config = {"http://localhost:9000/a b", secret, {"localhost:9000"}};
  CHECK_FALSE(webhook_target(config));
  config = {"http://user@localhost:9000/", secret, {"user@localhost:9000"}};
  CHECK_FALSE(webhook_target(config));
  config = {"http://localhost:9000/", (folder / "absent").string(), {"localhost:9000"}};
  CHECK_FALSE(webhook_target(config));
  testing::write_file(secret, "short\n");
  config.secret_file = secret;
  CHECK_FALSE(webhook_target(config));
}

}  // namespace popcutd_parts_test
