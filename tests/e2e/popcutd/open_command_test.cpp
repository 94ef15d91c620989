// SPDX-License-Identifier: MIT
// popcut open: a page in the browser, with a word that opens it once; a popcutd, if none runs.
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "daemon/client/http_client.hpp"
#include "tests/support/daemon_with_cli.hpp"

namespace open_command_test {

using namespace popcut::testing;
using Json = nlohmann::json;

namespace {

// Variables of the environment for one test.
class Environment {
 public:
  void set(const std::string& name, const std::string& value) {
    keep(name);
    ::setenv(name.c_str(), value.c_str(), 1);
  }
  void unset(const std::string& name) {
    keep(name);
    ::unsetenv(name.c_str());
  }
  ~Environment() {
    for (const auto& [name, value] : before_)
      if (value)
        ::setenv(name.c_str(), value->c_str(), 1);
      else
        ::unsetenv(name.c_str());
  }
  Environment() = default;
  Environment(const Environment&) = delete;
  Environment& operator=(const Environment&) = delete;

 private:
  void keep(const std::string& name) {
    const char* const now = std::getenv(name.c_str());
    before_.emplace(name, now == nullptr ? std::nullopt : std::optional<std::string>(now));
  }
  std::map<std::string, std::optional<std::string>> before_;
};

// A program that listens at a port of its own.
class OtherProgram {
 public:
  OtherProgram() : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in at{};
    at.sin_family = AF_INET;
    at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof at;
    REQUIRE(::bind(socket_, reinterpret_cast<sockaddr*>(&at), size) == 0);
    REQUIRE(::listen(socket_, 1) == 0);
    REQUIRE(::getsockname(socket_, reinterpret_cast<sockaddr*>(&at), &size) == 0);
    port_ = ntohs(at.sin_port);
  }
  ~OtherProgram() { ::close(socket_); }
  OtherProgram(const OtherProgram&) = delete;
  OtherProgram& operator=(const OtherProgram&) = delete;
  [[nodiscard]] int port() const { return port_; }

 private:
  int socket_, port_{};
};

// A folder with programs, before all others in PATH, and a screen.
struct Screen {
  TempFolder folder;
  Environment environment;

  Screen() {
    environment.set("PATH", folder.path().string() + ":" + std::getenv("PATH"));
    environment.set("DISPLAY", ":99");
    environment.unset("WAYLAND_DISPLAY");
  }
  // A browser that writes down what it is to open, then does `more`.
  void browser(const std::string& more = "") {
    const std::string program = folder / "xdg-open";
    write_file(program, fmt::format("#!/bin/sh\necho \"$@\" >>'{}'\necho 'opening' \"$@\"\n{}\n",
                                    (folder / "opened").string(), more));
    ::chmod(program.c_str(), 0755);
  }
  [[nodiscard]] std::string opened() const { return text_of_file(folder / "opened"); }
};

struct Page {
  std::string base, word;
};

Page page_in(const std::string& text) {
  const std::size_t at = text.find("#t=");
  REQUIRE(at != std::string::npos);
  const std::size_t begin = text.rfind("http://", at);
  REQUIRE(begin != std::string::npos);
  const std::size_t end = text.find_first_of(" \n\"", at);
  return {text.substr(begin, at - begin), text.substr(at + 3, end - at - 3)};
}

popcut::client::HttpClient client_of(const std::string& base) {
  const auto address = popcut::client::parse_address(base.substr(0, base.size() - 1));
  REQUIRE(address);
  return {{*address}, ""};
}

// What the page does with its word: the session's role, or the status that refuses it.
std::string session_of(const Page& page) {
  auto http = client_of(page.base);
  const std::string body = Json{{"one_shot", page.word}}.dump();
  const auto answer = http.ask({.method = "POST",
                                .target = "/v1/session",
                                .body = body,
                                .content_type = "application/json"});
  REQUIRE(answer);
  if (answer->status != 201) return std::to_string(answer->status);
  return Json::parse(answer->body).at("role");
}

// Who listens at a socket; whoever it is ends with the test.
struct Started {
  std::string socket;
  [[nodiscard]] pid_t pid() const {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    socket.copy(address.sun_path, sizeof(address.sun_path) - 1);
    const int one = ::socket(AF_UNIX, SOCK_STREAM, 0);
    ucred who{};
    socklen_t size = sizeof(who);
    pid_t found = -1;
    if (::connect(one, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0 &&
        ::getsockopt(one, SOL_SOCKET, SO_PEERCRED, &who, &size) == 0)
      found = who.pid;
    ::close(one);
    return found;
  }
  ~Started() {
    if (const pid_t who = pid(); who > 0) ::kill(who, SIGKILL);
  }
};

struct Workshop : DaemonWithCli {
  Workshop() { open(); }
};

}  // namespace

TEST_CASE("popcut open opens the page in the browser with a word that works once",
          "[popcutd][open]") {
  Screen screen;
  screen.browser();
  Workshop shop;
  const Ran ran = shop.popcut({"open"});
  INFO(ran.out << ran.err);
  REQUIRE(ran.exit == 0);
  const Page page = page_in(screen.opened());
  // Over the socket popcutd says where its page is: it chose a port of its own.
  CHECK(page.base == "http://localhost:" + shop.daemon.url().substr(17) + "/");
  auto http = client_of(page.base);
  const auto index = http.ask({.target = "/"});
  REQUIRE(index);
  CHECK(index->status == 200);
  CHECK(index->content_type.find("text/html") == 0);
  CHECK(session_of(page) == "admin");
  CHECK(session_of(page) == "401");
  // What is printed or logged may be read later, by others.
  CHECK_FALSE(says(ran.out + ran.err, page.word));
  CHECK_FALSE(says(shop.daemon.log(), page.word));
  CHECK(says(ran.out, "opened " + page.base));
}

TEST_CASE("popcut open prints the address where no browser opens it", "[popcutd][open]") {
  Workshop shop;
  const auto printed = [&](const Ran& ran) {
    INFO(ran.out << ran.err);
    REQUIRE(ran.exit == 0);
    return session_of(page_in(ran.out));
  };
  SECTION("it was asked to print") {
    Screen screen;
    screen.browser();
    const Ran ran = shop.popcut({"open", "--print"});
    CHECK(printed(ran) == "admin");
    CHECK(says(ran.err, "within a minute"));
    CHECK(shop.popcut({"open", "--print", "-q"}).err.empty());
    const Ran json = shop.popcut({"open", "--json"});
    CHECK(Json::parse(json.out).at("url").get<std::string>().find("#t=") != std::string::npos);
    CHECK_FALSE(std::filesystem::exists(screen.folder / "opened"));
  }
  SECTION("there is no screen") {
    Screen screen;
    screen.browser();
    screen.environment.unset("DISPLAY");
    CHECK(printed(shop.popcut({"open"})) == "admin");
    CHECK_FALSE(std::filesystem::exists(screen.folder / "opened"));
  }
  SECTION("the browser fails") {
    Screen screen;
    screen.browser("exit 3");
    const Ran ran = shop.popcut({"open"});
    CHECK(printed(ran) == "admin");
    CHECK(says(ran.err, "no browser was found"));
    CHECK_FALSE(says(ran.out, "opening"));
  }
  SECTION("there is no xdg-open") {
    Screen screen;
    screen.environment.set("PATH", screen.folder.path().string());
    CHECK(printed(shop.popcut({"open"})) == "admin");
  }
}

TEST_CASE("popcut open starts a popcutd that goes on if none runs", "[popcutd][open]") {
  Screen screen;
  screen.browser();
  TempFolder home;
  screen.environment.set("HOME", home.path());
  screen.environment.set("XDG_RUNTIME_DIR", (home / "run").string());
  screen.environment.set("XDG_STATE_HOME", (home / "state").string());
  screen.environment.set("XDG_CONFIG_HOME", (home / "config").string());
  screen.environment.unset("POPCUT_URL");
  screen.environment.unset("POPCUT_TOKEN");
  std::filesystem::create_directories(home / "run");
  std::filesystem::create_directories(home / "config/popcut");
  const std::string config = home / "config/popcut/popcutd.toml";
  const std::string log = home / "state/popcut/popcutd.log";
  const Started started{home / "run/popcut.sock"};
  const auto open = [&](const std::vector<std::string>& more = {}) {
    std::vector<std::string> words{popcut_program(), "open"};
    words.insert(words.end(), more.begin(), more.end());
    return run_program(words, home.path());
  };
  SECTION("it serves, and the next one finds it") {
    write_file(config, "listen = [\"127.0.0.1:0\"]\n");
    const Ran first = open();
    INFO(first.out << first.err << text_of_file(log));
    REQUIRE(first.exit == 0);
    CHECK(says(first.err, "starting popcutd in the background; its log is " + log));
    const Page page = page_in(screen.opened());
    CHECK(session_of(page) == "admin");
    const Ran second = open({"--print"});
    CHECK(second.exit == 0);
    CHECK_FALSE(says(second.err, "starting"));
    CHECK(page_in(second.out).base == page.base);
    const std::string said = text_of_file(log);
    CHECK(says(said, "serving at"));
    CHECK_FALSE(says(said, page.word));
    struct stat found {};
    REQUIRE(::stat(log.c_str(), &found) == 0);
    CHECK((found.st_mode & 077) == 0);
    const pid_t pid = started.pid();
    REQUIRE(pid > 0);
    CHECK(::getsid(pid) == pid);  // not in the terminal's
    REQUIRE(::kill(pid, SIGTERM) == 0);
    CHECK(comes_true([&] { return ::kill(pid, 0) != 0; }));
  }
  SECTION("it takes another port where another program has its own") {
    const OtherProgram other;
    write_file(config, fmt::format("listen = [\"127.0.0.1:{}\"]\n", other.port()));
    const Ran ran = open({"--print"});
    INFO(ran.out << ran.err << text_of_file(log));
    REQUIRE(ran.exit == 0);
    CHECK(says(ran.err, "another program has popcutd's port"));
    CHECK(session_of(page_in(ran.out)) == "admin");
    const pid_t pid = started.pid();
    REQUIRE(pid > 0);
    REQUIRE(::kill(pid, SIGTERM) == 0);
    CHECK(comes_true([&] { return ::kill(pid, 0) != 0; }));
  }
  SECTION("it says why it cannot") {
    write_file(config, "listen = [\"not an address\"]\n");
    const Ran ran = open();
    CHECK(ran.exit != 0);
    CHECK(says(ran.err, "popcutd: was started and has ended"));
    CHECK(says(ran.err, "its log is " + log));
    CHECK_FALSE(std::filesystem::exists(screen.folder / "opened"));
  }
  SECTION("a popcutd that was named is not replaced by another") {
    screen.environment.set("POPCUT_URL", (home / "run/none.sock").string());
    const Ran ran = open();
    CHECK(ran.exit != 0);
    CHECK_FALSE(std::filesystem::exists(log));
  }
}

TEST_CASE("popcut open says what a popcutd without TCP needs", "[popcutd][open]") {
  TempFolder folder;
  Environment environment;
  DaemonProcess daemon(popcutd_program());
  const std::string config = text_of_file(daemon.config());
  const std::size_t at = config.find("listen");
  REQUIRE(at != std::string::npos);
  write_file(daemon.config(),
             config.substr(0, at) + "listen = []" + config.substr(config.find('\n', at)));
  REQUIRE(daemon.start());
  environment.set("POPCUT_URL", daemon.socket());
  const Ran ran = run_program({popcut_program(), "open", "--print"}, folder.path());
  CHECK(ran.exit == 5);
  CHECK(says(ran.err, "listens on no TCP address"));
  CHECK(ran.out.empty());
}

}  // namespace open_command_test
