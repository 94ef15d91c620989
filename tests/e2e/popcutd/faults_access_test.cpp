// SPDX-License-Identifier: MIT
// Who was let in, and is no more: tokens that are deleted, users who lose their role.
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "tests/support/paths.hpp"
#include "tests/support/raw_http.hpp"
#include "tests/support/running_daemon.hpp"

namespace faults_access_test {

using namespace popcut;
using namespace popcut::testing;
using daemon::RawConnection;
using daemon::WireResponse;
using Json = nlohmann::json;

namespace {

constexpr unsigned kUser = 65534;

// A popcutd, and what is sent to it with a token, or as a user of the socket.
class Lab : public RunningDaemon {
 public:
  explicit Lab(const std::string& more = "")
      : RunningDaemon(0, "failed_logins_per_minute = 1000\n" + more) {
    open();
    const std::string url = daemon().url();
    port = static_cast<std::uint16_t>(std::stoi(url.substr(url.rfind(':') + 1)));
  }
  [[nodiscard]] std::string head(const std::string& method, const std::string& path,
                                 const std::string& token, std::size_t length) const {
    static int keys = 0;
    std::string text = fmt::format("{} {} HTTP/1.1\r\nHost: localhost:{}\r\n", method, path, port);
    if (!token.empty()) text += "Authorization: Bearer " + token + "\r\n";
    if (method != "GET")
      text += fmt::format(
          "Content-Type: application/json\r\nIdempotency-Key: faults-access-{:08}\r\n"
          "If-Match: *\r\nContent-Length: {}\r\n",
          ++keys, length);
    return text + "\r\n";
  }
  WireResponse send(const std::string& method, const std::string& path, const std::string& token,
                    const std::string& body = "{}") {
    RawConnection connection(port);
    connection.send(head(method, path, token, body.size()) + (method == "GET" ? "" : body));
    return connection.receive();
  }
  int status(const std::string& path, const std::string& token) {
    return send("GET", path, token).status;
  }
  Json token(const std::string& role) {
    return Json::parse(
        ask("POST", "/v1/tokens", Json{{"name", "lab"}, {"role", role}}.dump()).body);
  }
  /// The token of a page that this word opens.
  std::string page(const std::string& word) {
    const WireResponse opened = send("POST", "/v1/session", "", Json{{"one_shot", word}}.dump());
    INFO(opened.body);
    REQUIRE(opened.status == 201);
    return Json::parse(opened.body).at("token");
  }
  std::string word_of(const WireResponse& made) {
    INFO(made.body);
    REQUIRE(made.status == 201);
    return Json::parse(made.body).at("one_shot");
  }
  RawConnection stream(const std::string& token) {
    RawConnection connection(port);
    std::string text = head("GET", "/v1/events", token, 0);
    text.insert(text.size() - 2, "Accept: text/event-stream\r\n");
    connection.send(text);
    REQUIRE(connection.receive_until("event: snapshot").find("200 OK") != std::string::npos);
    return connection;
  }
  void reload(const std::string& config) {
    write_file(daemon().config(), config);
    const std::string before = daemon().log();
    daemon().signal(SIGHUP);
    REQUIRE(happens([&] {
      return daemon().log().find("configuration reloaded", before.size()) != std::string::npos;
    }));
  }
  std::uint16_t port{};
};

}  // namespace

TEST_CASE("the sessions of a token that is deleted move no knife and their streams end at once",
          "[daemon][popcutd][access]") {
  Lab lab;
  const std::string job = lab.ready_job(lab.design(Lab::lines_svg(3)));
  const Json token = lab.token("operator");
  const std::string secret = token.at("token");
  const auto word = [&](const std::string& by) {
    return lab.word_of(lab.send("POST", "/v1/session/one-shot", by));
  };
  const std::string page = lab.page(word(secret));
  const std::string second = lab.page(word(page));
  const std::string late = word(page);
  RawConnection one = lab.stream(page), two = lab.stream(second);
  REQUIRE(lab.get("/v1/sessions").at("items").size() == 2);
  REQUIRE(lab.status("/v1/jobs", page) == 200);
  const std::string path = "/v1/jobs/" + job + "/actions/";
  // Half of a request is here when its token goes.
  const std::string arm = R"({"sheet": 1})";
  RawConnection slow(lab.port);
  std::string head = lab.head("POST", path + "arm", secret, arm.size());
  head.replace(head.find("If-Match: *"), 11,
               fmt::format("If-Match: \"{}\"", lab.job(job).at("rev").get<int>()));
  slow.send(head + arm.substr(0, 3));

  REQUIRE(lab.ask("DELETE", "/v1/tokens/" + token.at("id").get<std::string>()).status == 204);
  CHECK(one.closes(3));  // long before the next heartbeat
  CHECK(two.closes(3));
  slow.send(arm.substr(3));
  CHECK(slow.receive().status == 401);
  for (const std::string& by : {secret, page, second})
    for (const char* action : {"arm", "start", "cancel"})
      CHECK(lab.send("POST", path + action, by, std::string(action) == "arm" ? arm : "{}").status ==
            401);
  CHECK(lab.send("POST", "/v1/session", "", Json{{"one_shot", late}}.dump()).status == 401);
  CHECK(lab.job(job).at("state") == "ready");
  CHECK(lab.get("/v1/sessions").at("items").empty());
  lab.daemon().signal(SIGTERM);
  REQUIRE(lab.daemon().wait() == 0);
  lab.open();
  const std::string url = lab.daemon().url();
  lab.port = static_cast<std::uint16_t>(std::stoi(url.substr(url.rfind(':') + 1)));
  CHECK(lab.status("/v1/jobs", page) == 401);
}

TEST_CASE("the sessions of a user have the role that SIGHUP leaves and end with the last one",
          "[daemon][popcutd][access]") {
  Lab lab;
  const std::string before = text_of_file(lab.daemon().config());
  const auto user = [&](const std::string& role) {
    return before + fmt::format("[[user]]\nuid = {}\nrole = \"{}\"\n", kUser, role);
  };
  lab.reload(user("operator"));
  auto nobody = RawConnection::as_user(kUser, lab.daemon().socket());
  if (!nobody) {
    WARN("only root can be another user: not checked here");
    return;
  }
  nobody->send(lab.head("POST", "/v1/session/one-shot", "", 2) + "{}");
  const std::string page = lab.page(lab.word_of(nobody->receive()));
  nobody->send(lab.head("POST", "/v1/session/one-shot", "", 2) + "{}");
  const std::string late = lab.word_of(nobody->receive());
  const std::string job = lab.ready_job(lab.design(Lab::lines_svg(3)));
  const auto arm = [&] {
    RawConnection connection(lab.port);
    std::string text = lab.head("POST", "/v1/jobs/" + job + "/actions/arm", page, 12);
    text.replace(text.find("If-Match: *"), 11,
                 fmt::format("If-Match: \"{}\"", lab.job(job).at("rev").get<int>()));
    connection.send(text + R"({"sheet": 1})");
    return connection.receive().status;
  };
  RawConnection stream = lab.stream(page);
  REQUIRE(arm() == 200);
  lab.reload(user("viewer"));
  // Armed by an operator, who is none any more.
  CHECK(lab.send("POST", "/v1/jobs/" + job + "/actions/start", page).status == 403);
  CHECK(arm() == 403);
  CHECK(lab.status("/v1/jobs", page) == 200);
  lab.reload(before);
  CHECK(stream.closes(3));
  CHECK(lab.status("/v1/jobs", page) == 401);
  CHECK(lab.send("POST", "/v1/session", "", Json{{"one_shot", late}}.dump()).status == 401);
  lab.reload(user("operator"));
  CHECK(lab.status("/v1/jobs", page) == 401);
}

TEST_CASE("a limit that SIGHUP raises gets its descriptors or popcutd says that it does not",
          "[daemon][popcutd][access]") {
  Lab lab("connections = 20\n");
  const std::string before = text_of_file(lab.daemon().config());
  const auto with = [&](int connections) {
    std::string text = before;
    text.replace(text.find("connections = 20"), 16, fmt::format("connections = {}", connections));
    return text;
  };
  const auto limit = [&](rlim_t soft, rlim_t hard) {
    const rlimit wanted{soft, hard};
    REQUIRE(::prlimit(lab.daemon().pid(), RLIMIT_NOFILE, &wanted, nullptr) == 0);
  };
  limit(120, 2000);
  lab.reload(with(900));
  rlimit now{};
  REQUIRE(::prlimit(lab.daemon().pid(), RLIMIT_NOFILE, nullptr, &now) == 0);
  CHECK(now.rlim_cur >= 900);
  CHECK(lab.daemon().log().find("this process may open") == std::string::npos);
  lab.reload(with(4000));
  CHECK(lab.daemon().log().find("this process may open 2000 files, which is enough for about 19") !=
        std::string::npos);
}

}  // namespace faults_access_test
