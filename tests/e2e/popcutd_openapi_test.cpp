// SPDX-License-Identifier: MIT
// The real daemon answers as the description that it serves says, through the life of a job.
#include <chrono>
#include <csignal>
#include <fstream>
#include <iterator>
#include <map>
#include <thread>

#include <fmt/format.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "tests/support/daemon_process.hpp"
#include "tests/support/json_schema.hpp"
#include "tests/support/raw_http.hpp"

using nlohmann::json;
using popcut::JsonSchema;
using popcut::daemon::RawConnection;
using popcut::daemon::WireResponse;
using popcut::testing::DaemonProcess;

namespace {

const std::string kJson = "Content-Type: application/json\r\n";

// Asks over the unix socket, as root or the daemon's own user, and holds every answer against the
// description.
class Caller {
 public:
  explicit Caller(std::string path) : path_(std::move(path)) {
    document_ = json::parse(send("GET", "/v1/openapi.json", "", "").body);
  }

  WireResponse ask(const std::string& method, const std::string& route,
                   const std::map<std::string, std::string>& holes = {},
                   const std::string& more = "", const std::string& body = "") {
    const std::size_t mark = route.find('?');
    std::string target = route;
    for (const auto& [name, value] : holes)
      if (const std::size_t at = target.find("{" + name + "}"); at != std::string::npos)
        target.replace(at, name.size() + 2, value);
    const WireResponse response = send(method, target, more, body);
    std::string verb = method;
    for (char& c : verb) c = static_cast<char>(c - 'A' + 'a');
    hold(document_.at("paths").at(route.substr(0, mark)).at(verb).at("responses"), response,
         method + " " + target);
    return response;
  }

  json get(const std::string& route, const std::map<std::string, std::string>& holes = {}) {
    const WireResponse response = ask("GET", route, holes, "Accept: application/json\r\n");
    INFO(route << response.body.substr(0, 300));
    CHECK(response.status == 200);
    return json::parse(response.body, nullptr, false);
  }

  static std::string key() {
    static int number = 0;
    return kJson + fmt::format("Idempotency-Key: live-contract-{:06}\r\n", ++number);
  }

  [[nodiscard]] const json& document() const { return document_; }

 private:
  WireResponse send(const std::string& method, const std::string& target, const std::string& more,
                    const std::string& body) const {
    RawConnection connection(path_);
    connection.send(fmt::format("{} {} HTTP/1.1\r\nHost: popcut\r\nContent-Length: {}\r\n{}\r\n{}",
                                method, target, body.size(), more, body));
    return connection.receive(60);
  }

  void hold(const json& responses, const WireResponse& response, const std::string& what) const {
    INFO(what << " gave " << response.status << ": " << response.body.substr(0, 300));
    const std::string status = std::to_string(response.status);
    CHECK(responses.contains(status));
    if (!responses.contains(status)) return;
    const JsonSchema schema(document_);
    const json& documented = schema.resolved(responses.at(status));
    if (!documented.contains("content")) {
      CHECK(response.body.empty());
      return;
    }
    const std::string whole = response.headers.at("content-type");
    const std::string type = whole.substr(0, whole.find(';'));
    CHECK(documented.at("content").contains(type));
    if (type.find("json") == std::string::npos || !documented.at("content").contains(type)) return;
    const json& content = documented.at("content").at(type);
    if (!content.contains("schema")) return;
    for (const std::string& fault : schema.faults(json::parse(response.body), content.at("schema")))
      FAIL_CHECK(fault);
  }

  std::string path_;
  json document_;
};

std::string text_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

// The job in state `state`, within a minute.
json job_in(Caller& caller, const std::string& job, const std::string& state) {
  const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (true) {
    json now = caller.get("/v1/jobs/{id}", {{"id", job}});
    if (now.at("state") == state || std::chrono::steady_clock::now() > until) {
      CHECK(now.at("state") == state);
      return now;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
}

}  // namespace

TEST_CASE("the real daemon answers as its own description says", "[daemon][popcutd][openapi]") {
  DaemonProcess daemon(POPCUTD_PROGRAM);
  const bool serves = daemon.start();
  INFO(daemon.log());
  REQUIRE(serves);
  Caller caller(daemon.socket());
  const WireResponse stored = caller.ask("POST", "/v1/designs?name=ball", {}, kJson,
                                         text_of(POPCUT_SOURCE_DIR "/examples/sphere.json"));
  REQUIRE(stored.status == 201);
  const std::string design = json::parse(stored.body).at("id");
  CHECK(caller.ask("POST", "/v1/designs", {}, kJson, "{").status == 422);
  CHECK(caller.ask("POST", "/v1/assets", {}, "Content-Type: model/stl\r\n", "solid a\nendsolid a\n")
            .status == 201);
  const WireResponse made =
      caller.ask("POST", "/v1/jobs", {}, Caller::key(), json{{"design", design}}.dump());
  REQUIRE(made.status == 201);
  const std::string job = json::parse(made.body).at("id");
  job_in(caller, job, "ready");
  const std::string plan = caller.get("/v1/jobs/{id}", {{"id", job}}).at("plan");

  const auto read_all = [&] {
    for (const auto& [route, operations] : caller.document().at("paths").items()) {
      if (!operations.contains("get")) continue;
      std::map<std::string, std::string> holes{{"k", "1"}};
      for (const auto& [prefix, id] :
           std::map<std::string, std::string>{{"/v1/jobs/", job},
                                              {"/v1/designs/", design},
                                              {"/v1/plans/", plan},
                                              {"/v1/devices/", "sim:cameo3"},
                                              {"/v1/materials/", "paper-220"}})
        if (route.starts_with(prefix)) holes["id"] = id;
      caller.get(route, holes);
      if (holes.count("id") == 0) continue;
      for (const char* other : {"01JD0000000000000000000001", "a!b"})
        CHECK(caller.ask("GET", route, {{"id", other}, {"k", "1"}}).status == 404);
    }
  };
  const auto act = [&](const std::string& action, const json& body, const std::string& match = "") {
    const std::string etag =
        match.empty()
            ? fmt::format("\"{}\"", caller.get("/v1/jobs/{id}", {{"id", job}}).at("rev").get<int>())
            : match;
    return caller
        .ask("POST", "/v1/jobs/{id}/actions/" + action, {{"id", job}},
             Caller::key() + "If-Match: " + etag + "\r\n", body.dump())
        .status;
  };
  read_all();
  CHECK(act("start", json::object()) == 409);
  CHECK(act("arm", {{"sheet", 2}}) == 409);
  CHECK(act("arm", {{"sheet", 1}}, "\"999\"") == 412);
  CHECK(act("arm", {{"sheet", 1}}) == 200);
  CHECK(act("disarm", json::object(), "*") == 200);
  CHECK(act("arm", {{"sheet", 1}}) == 200);
  CHECK(act("start", {{"sheet", 1}}) == 200);
  const json done = job_in(caller, job, "done");
  CHECK(done.at("progress").at("paths_certain") == done.at("progress").at("paths_total"));
  for (const char* action : {"pause", "resume", "cancel", "disarm"})
    CHECK(act(action, json::object()) == 409);
  CHECK(act("resume-from", {{"from_path", 0}, {"registration", "kept"}}) == 409);
  read_all();
  CHECK(caller.ask("DELETE", "/v1/jobs/{id}", {{"id", job}}).status == 204);
  CHECK(caller.ask("POST", "/v1/db/actions/check", {}, kJson, "{}").status == 200);
  daemon.signal(SIGTERM);
  CHECK(daemon.wait() == 0);
}
