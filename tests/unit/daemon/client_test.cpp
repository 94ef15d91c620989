// SPDX-License-Identifier: MIT
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <atomic>
#include <map>
#include <random>
#include <string>
#include <thread>

#include <fmt/format.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "core/text/words.hpp"
#include "daemon/client/address.hpp"
#include "daemon/client/api.hpp"
#include "daemon/client/command_words.hpp"
#include "daemon/client/problem_line.hpp"
#include "daemon/client/sse_reader.hpp"
#include "tests/support/process.hpp"

namespace client_test {

using namespace popcut;
using namespace popcut::client;

namespace {

Environment environment(std::map<std::string, std::string> values) {
  return [values = std::move(values)](const char* name) -> const char* {
    const auto found = values.find(name);
    return found == values.end() ? nullptr : found->second.c_str();
  };
}

std::string told(int status, const std::string& body) {
  HttpResponse response;
  response.status = status;
  response.body = body;
  return message(error_from(response, "job 01J"));
}

}  // namespace

TEST_CASE("the client finds popcutd through the environment", "[client]") {
  const auto url = addresses(environment({{"POPCUT_URL", "http://[::1]:9000/"}}));
  REQUIRE(url);
  REQUIRE(url->size() == 1);
  CHECK(url->front().text() == "http://[::1]:9000");
  CHECK(url->front().host_header() == "[::1]:9000");
  const auto plain = addresses(environment({{"XDG_RUNTIME_DIR", "/run/user/7"}, {"HOME", "/h"}}));
  REQUIRE(plain);
  REQUIRE(plain->size() == 3);
  CHECK((*plain)[0].text() == "/run/user/7/popcut.sock");
  CHECK((*plain)[1].text() == "/h/.local/state/popcut/popcut.sock");
  CHECK((*plain)[2].text() == "/run/popcut.sock");
  CHECK(plain->front().host_header() == "localhost");
  const auto token = addresses(environment({{"POPCUT_TOKEN", "pc_1_2"}}));
  REQUIRE(token);
  CHECK(token->front().text() == "http://127.0.0.1:8631");
}

TEST_CASE("an invalid address is refused with a valid example", "[client]") {
  for (const char* wrong : {"", "popcut.sock", "https://x", "http://", "http://a:0",
                            "http://a:99999", "http://a:8631/v1", "http://user@a", "ftp://x",
                            "http://[::1", "http://[::1:80", "http://::1", "http://a]", "http://[]",
                            "http://a\x1b[31m", "http://a\r\nX: y", "http://a\x7f"}) {
    CAPTURE(wrong);
    const auto address = parse_address(wrong);
    REQUIRE_FALSE(address);
    CHECK(address.error().kind == ErrorKind::Usage);
    CHECK(address.error().detail.find("http://127.0.0.1:8631") != std::string::npos);
  }
  CHECK_FALSE(parse_address("/" + std::string(107, 'x')));
  CHECK(parse_address("/" + std::string(106, 'x')));
  CHECK(parse_address("unix:/a")->path == "/a");
  CHECK(parse_address("http://cutter")->port == 8631);
  CHECK(parse_address("http://[::1]")->host == "::1");
  CHECK(parse_address("http://[fe80::1%eth0]:9")->host == "fe80::1%eth0");
  CHECK(message(parse_address("http://[::1").error()).find("between [ and ]") != std::string::npos);
}

TEST_CASE("an event stream is read completely in pieces of any size", "[client]") {
  const std::string stream =
      "\n: heartbeat\n\nid: 7\nevent: job\ndata: {\"a\":\ndata:1}\n\nevent:progress\r\n"
      "data: x\r\n\r\nid: 9\n\ndata\n\n";
  std::mt19937 random(7);
  for (int round = 0; round < 200; ++round) {
    SseReader reader;
    std::vector<SseEvent> events;
    for (std::size_t at = 0; at < stream.size();) {
      const std::size_t piece = 1 + random() % 9;
      for (SseEvent& event : reader.feed(std::string_view(stream).substr(at, piece)))
        events.push_back(std::move(event));
      at += piece;
    }
    REQUIRE(events.size() == 3);
    CHECK(events[0].kind == "job");
    CHECK(events[0].data == "{\"a\":\n1}");
    CHECK(events[0].id == "7");
    CHECK(events[1].kind == "progress");
    CHECK(events[1].data == "x");
    CHECK(events[2].kind == "message");
    CHECK(events[2].data.empty());
    CHECK(reader.last_id() == "9");
  }
}

TEST_CASE("an endless event is not kept", "[client]") {
  SseReader reader(1000);
  for (int k = 0; k < 100; ++k) CHECK(reader.feed("data: " + std::string(90, 'x') + "\n").empty());
  CHECK(reader.broken());
}

TEST_CASE("a problem of popcutd becomes one line that says what would be right", "[client]") {
  CHECK(told(422, R"({"type":"https://popcut.invalid/p/validation","title":"Request is not valid",
      "status":422,"errors":[{"pointer":"/copies","code":"range","detail":"must be 1..1000"},
      {"pointer":"/materiel","code":"unknown_member","detail":"is not known; did you mean /material?"}]})") ==
        "--copies: must be 1..1000 (and 1 more)");
  CHECK(told(409, R"({"type":"https://popcut.invalid/p/state-conflict","title":"Not now",
      "detail":"sheet 2 is not the current one","state":"ready",
      "allowed_actions":["arm","confirm-result"]})") ==
        "job 01J: sheet 2 is not the current one; it is ready; possible now: arm, confirm");
  CHECK(told(502, "<html>").find("502") != std::string::npos);
  CHECK(told(401, R"({"type":"x/unauthenticated","detail":"who are you"})").find("POPCUT_TOKEN") !=
        std::string::npos);
  CHECK(told(422, R"({"type":"p/validation","errors":[{"pointer":"/materiel",
      "code":"unknown_member","detail":"is not known; did you mean /material?"}]})") ==
        "job 01J: /materiel: is not known; did you mean --material?");
  HttpResponse infeasible;
  infeasible.status = 422;
  infeasible.body =
      R"({"type":"p/validation","errors":[{"pointer":"","code":"infeasible","detail":"no"}]})";
  CHECK(exit_code(error_from(infeasible, "a").kind) == 4);
  HttpResponse whole;
  whole.status = 409;
  whole.body =
      R"({"type":"p/state-conflict","detail":"no","state":"interrupted","allowed_actions":["x"],
          "instance":"/v1/jobs/01JD/actions/resume-from","ways":[
          {"action":"resume-from","body":{"from_path":6,"registration":"re-registered",
           "skip_in_doubt":true}},
          {"action":"resume-from","body":{"from_path":4,"registration":"kept",
           "i_accept_double_cut":true}},
          {"action":"retry-sheet","body":{"sheet":2}},
          {"action":"confirm-result","body":{"sheet":2,"good":true}},
          {"action":"arm","body":{"sheet":2,"blank":3,"device":"sim:a"}},
          {"action":"change","body":{"site":"ground floor"}},
          {"action":"release","body":{"job":"01JD"}},{"action":"start","body":{"sheet":2}}]})";
  CHECK(message(error_from(whole, "job 01J")) ==
        "job 01J: no; it is interrupted; possible now: "
        "popcut resume 01JD --from 6 --registration re-registered --skip-in-doubt "
        "(skips what is in doubt), or popcut resume 01JD --from 4 --accept-double-cut "
        "(cuts again what may be cut already), or popcut retry 01JD 2, or "
        "popcut confirm 01JD 2 good, or popcut arm 01JD 2 --blank 3 --device sim:a, or "
        "popcut change 01JD --site 'ground floor', or "
        "popcut release 01JD, or popcut start 01JD");
}

TEST_CASE("a wrong value of an option is a usage error that quotes it", "[client]") {
  const auto error = [](const char* fault, Subject subject, const nlohmann::json& sent) {
    HttpResponse response;
    response.status = 422;
    response.body = std::string(R"({"type":"p/validation","errors":[)") + fault + "]}";
    return error_from(response, "job 01J", subject, &sent);
  };
  const char* const sheet = R"({"pointer":"/sheet","code":"range","detail":"must be 1..9"})";
  const Error wrong = error(sheet, Subject::CommandLine, {{"sheet", 12}});
  CHECK(message(wrong) == "SHEET: is 12; must be 1..9");
  CHECK(exit_code(wrong.kind) == 2);
  // As popcutd repeats it, where it does; told once.
  CHECK(message(error(R"({"pointer":"?state","detail":"must be states","got":"foo"})",
                      Subject::CommandLine, nullptr)) == "--state: is \"foo\"; must be states");
  CHECK(message(error(R"({"pointer":"/material","detail":"there is no material \"foo\""})",
                      Subject::CommandLine, {{"material", "foo"}})) ==
        "--material: there is no material \"foo\"");
  CHECK(message(error(R"({"pointer":"/options/snap","detail":"no length"})", Subject::CommandLine,
                      {{"options", {{"snap", "x"}}}})) == "--snap: is \"x\"; no length");
  // What cannot be made, and what a file holds, is no wrong command line.
  CHECK(exit_code(error(R"({"pointer":"/options/mat","code":"infeasible","detail":"too small"})",
                        Subject::CommandLine, {{"options", {{"mat", "1x1"}}}})
                      .kind) == 4);
  CHECK(exit_code(error(R"({"pointer":"/design","code":"unknown","detail":"no"})",
                        Subject::CommandLine, {{"design", "x"}})
                      .kind) == 3);
  CHECK(exit_code(error(sheet, Subject::File, {{"sheet", 12}}).kind) == 3);
  // The name of an upload is an option, whatever is in the file.
  const Error name = error(R"({"pointer":"?name","detail":"must be short"})", Subject::File, {});
  CHECK(message(name) == "--name: must be short");
  CHECK(exit_code(name.kind) == 2);
  // Whatever a server sends.
  for (const char* pointer : {"/", "//", "/sheet/x", "/sheet~", "?", "/options/", "/sheet/"})
    CHECK_FALSE(
        message(error((R"({"detail":"no","pointer":")" + std::string(pointer) + "\"}").c_str(),
                      Subject::CommandLine, {{"sheet", {1, 2}}}))
            .empty());
}

TEST_CASE("a problem names command-line options and not JSON members", "[client]") {
  CHECK(
      told(
          409,
          R"({"type":"p/state-conflict","state":"interrupted","detail":"register it again and say registration \"re-registered\"",
      "allowed_actions":["resume-from","retry-sheet"]})")
          .find("say --registration re-registered; it is interrupted; possible now: "
                "resume --from, retry") != std::string::npos);
  CHECK(
      told(
          409,
          R"({"type":"p/state-conflict","detail":"say i_accept_double_cut, or take one with retry-sheet"})")
          .find("say --accept-double-cut, or") != std::string::npos);
  CHECK(
      told(403, R"({"type":"p/forbidden","detail":"confirm-result requires the role operator"})") ==
      "job 01J: confirm requires the role operator; 'popcut token create --role operator' creates "
      "a token for POPCUT_TOKEN, on the computer where popcutd runs");
  CHECK(option_for("/options/mat") == "--mat");
  CHECK(option_for("/from_path") == "--from");
  CHECK(option_for("?limit") == "--limit");
  CHECK(option_for("/surface/radius").empty());
  // A pointer into a file is a place in that file.
  HttpResponse spec;
  spec.status = 422;
  spec.body = R"({"type":"p/validation","errors":[{"pointer":"/material","code":"unknown",
      "detail":"there is no such material"}]})";
  CHECK(message(error_from(spec, "sphere.json", Subject::File)) ==
        "sphere.json: /material: there is no such material");
}

TEST_CASE("a query's value is encoded", "[client]") {
  CHECK(percent_encoded("a b&c=\xC3\xA9") == "a%20b%26c%3D%C3%A9");
}

TEST_CASE("a token with characters that no header allows is refused before it is sent",
          "[client]") {
  CHECK(bearer_token(environment({}))->empty());
  CHECK(bearer_token(environment({{"POPCUT_TOKEN", "pc_1_2"}})) == "pc_1_2");
  for (const char* wrong : {"pc_\n", "pc_ 1", "pc_\x1b", "pc_\xC3\xA9"}) {
    const auto token = bearer_token(environment({{"POPCUT_TOKEN", wrong}}));
    REQUIRE_FALSE(token);
    CHECK(exit_code(token.error().kind) == 2);
    CHECK(message(token.error()).rfind("POPCUT_TOKEN: contains a character", 0) == 0);
  }
}

TEST_CASE("an unknown host is reported", "[client]") {
  Api api(HttpClient({Address{{}, "cutter.invalid", 8631}}, ""));
  api.http().set_tries(0);
  const auto jobs = api.open_jobs();
  REQUIRE_FALSE(jobs);
  CHECK(jobs.error().kind == ErrorKind::DeviceGone);
  CHECK(jobs.error().detail.rfind("the host cutter.invalid is unknown", 0) == 0);
}

TEST_CASE("an absent popcutd is reported with how to start it", "[client]") {
  Api api(HttpClient({Address{"/nonexistent/popcut.sock", {}, 0}}, ""));
  api.http().set_tries(0);
  const auto jobs = api.open_jobs();
  REQUIRE_FALSE(jobs);
  CHECK(jobs.error().kind == ErrorKind::DeviceGone);
  CHECK(jobs.error().place == "/nonexistent/popcut.sock");
  CHECK(jobs.error().detail.find("'popcutd'") != std::string::npos);
}

namespace {

/// A server that answers each request with the same bytes, and then with `more` for ever.
class OddServer {
 public:
  OddServer(std::string answer, std::string more = "")
      : answer_(std::move(answer)), more_(std::move(more)) {
    sockaddr_un at{};
    at.sun_family = AF_UNIX;
    path().copy(at.sun_path, sizeof at.sun_path - 1);
    listener_ = ::socket(AF_UNIX, SOCK_STREAM, 0);
    REQUIRE(::bind(listener_, reinterpret_cast<const sockaddr*>(&at), sizeof at) == 0);
    REQUIRE(::listen(listener_, 8) == 0);
    thread_ = std::thread([this] { serve(); });
  }
  ~OddServer() {
    ending_ = true;
    ::shutdown(listener_, SHUT_RDWR);
    thread_.join();
    ::close(listener_);
  }
  [[nodiscard]] std::string path() const { return (folder_ / "socket").string(); }
  [[nodiscard]] Api api() const { return Api(HttpClient({Address{path(), {}, 0}}, "")); }

 private:
  void serve() {
    for (int one = 0; (one = ::accept(listener_, nullptr, nullptr)) >= 0; ::close(one)) {
      char block[4096];
      if (::recv(one, block, sizeof block, 0) <= 0) continue;
      bool open = ::send(one, answer_.data(), answer_.size(), MSG_NOSIGNAL) > 0;
      while (open && !more_.empty() && !ending_) {
        open = ::send(one, more_.data(), more_.size(), MSG_NOSIGNAL) > 0;
        if (more_.size() == 1) ::usleep(20'000);
      }
    }
  }
  testing::TempFolder folder_;
  std::string answer_, more_;
  std::atomic<bool> ending_{false};
  int listener_{-1};
  std::thread thread_;
};

std::string json_answer(const std::string& body) {
  return fmt::format(
      "HTTP/1.1 200 OK\r\nContent-Type: application/json\r\nContent-Length: {}\r\n\r\n{}",
      body.size(), body);
}

}  // namespace

TEST_CASE("what another server sends is printable", "[client]") {
  const OddServer server(
      json_answer(R"({"a\u001bb": ["x\u001b[31m\u009b", {"note": "one\u0007\ntwo"}], "n": 1})"));
  const auto got = server.api().get("/v1/meta", "meta");
  REQUIRE(got);
  for (const unsigned char c : got->dump()) CHECK((c >= 0x20 && c != 0x7F));
  CHECK((*got)["a b"][0] == "x [31m ");
  CHECK((*got)["a b"][1]["note"] == "one \ntwo");
  CHECK(shown_lines("a\x1b[2J\nb\n") == "a [2J\nb\n");
}

TEST_CASE("an answer that does not end or comes drop by drop is given up", "[client]") {
  const std::string head = "HTTP/1.1 200 OK\r\nContent-Length: 1000000000000\r\n\r\n";
  SECTION("too much") {
    const OddServer server("HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\n",
                           "10000\r\n" + std::string(65536, ' ') + "\r\n");
    HttpRequest request{"GET", "/v1/meta"};
    request.most_bytes = 1 << 20;
    const auto got = server.api().http().ask(std::move(request));
    REQUIRE_FALSE(got);
    CHECK(got.error().detail.find("more than 1048576 bytes") != std::string::npos);
  }
  SECTION("more than is taken of any answer") {
    const OddServer server(head);
    const auto got = server.api().get("/v1/meta", "meta");
    REQUIRE_FALSE(got);
    CHECK(got.error().kind == ErrorKind::Refused);
    CHECK(got.error().detail.find("more than 268435456 bytes") != std::string::npos);
  }
  SECTION("too slowly") {
    const OddServer server("HTTP/1.1 200 OK\r\nContent-Length: 100000\r\n\r\n", "x");
    HttpRequest request{"GET", "/v1/meta"};
    request.seconds = 0.2;
    const auto got = server.api().http().ask(std::move(request));
    REQUIRE_FALSE(got);
    CHECK(got.error().kind == ErrorKind::Refused);
    CHECK(got.error().detail.find("too slowly") != std::string::npos);
  }
}

}  // namespace client_test
