// SPDX-License-Identifier: MIT
// The real popcutd answers as the description that it serves says: each route and each documented
// status is produced here, or stands in a list with the reason why it cannot be.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <fstream>
#include <iterator>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "daemon/service/problem.hpp"
#include "tests/support/contract_caller.hpp"
#include "tests/support/daemon_process.hpp"
#include "tests/support/fault_page.hpp"

using nlohmann::json;
using popcut::daemon::RawConnection;
using popcut::daemon::WireResponse;
using popcut::testing::ContractCall;
using popcut::testing::ContractCaller;
using popcut::testing::DaemonProcess;
using popcut::testing::FaultPage;
using popcut::testing::TempFolder;

namespace {

const std::string kUnknown = "01JD0000000000000000000001";
const std::string kJson = "Accept: application/json\r\n";

std::string text_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::string quoted(const json& rev) { return fmt::format("\"{}\"", rev.get<std::int64_t>()); }

// Every documented operation, as a call with the example of its body, about what is not there.
std::vector<ContractCall> all_calls(const ContractCaller& caller) {
  std::vector<ContractCall> calls;
  for (const auto& [route, operations] : caller.document().at("paths").items())
    for (const auto& [method, ignored] : operations.items()) {
      ContractCall call{.method = method, .route = route, .more = kJson};
      for (char& c : call.method) c = static_cast<char>(c - 'a' + 'A');
      call.holes = {{"id", kUnknown}, {"k", "1"}};
      if (route.starts_with("/v1/devices/")) call.holes["id"] = "sim:nowhere";
      if (route.starts_with("/v1/materials/")) call.holes["id"] = "nothing";
      calls.push_back(std::move(call));
    }
  return calls;
}

bool documents(const ContractCaller& caller, const ContractCall& call, int status) {
  return caller.operation(call).at("responses").contains(std::to_string(status));
}

// A popcutd that lives through everything that its description knows.
class Life {
 public:
  Life()
      : daemon_(POPCUTD_PROGRAM, 0, configuration()),
        page_((daemon_.folder() / "control").string()) {
    page_.calm();
    const bool serves = daemon_.start(page_.environment());
    INFO(daemon_.log());
    REQUIRE(serves);
    caller_.emplace(daemon_.socket());
    const std::string url = daemon_.url();
    port_ = static_cast<std::uint16_t>(std::stoi(url.substr(url.rfind(':') + 1)));
    viewer_ = new_token("viewer");
    admin_ = new_token("admin");
  }

  ContractCaller& caller() { return *caller_; }
  int end() {
    daemon_.signal(SIGTERM);
    return daemon_.wait();
  }

  void make_design_and_plans();
  void knock();
  void use_devices_and_materials();
  void see_a_job_through();
  void pause_a_cut();
  void mend_a_sheet();
  void read_everything();
  void open_sessions();
  void fill_the_queue();
  void fill_the_disk();

 private:
  std::string configuration() {
    popcut::testing::write_file(
        files_ / "faults.json",
        R"({"popcut": 1, "faults": [{"at_path": 2, "kind": "cancel", "seconds": 1}]})");
    // Into [limits] first; then a slow cutter, one that breaks, and one that is not there. Their
    // plans fit no other.
    return fmt::format(
        "queue_jobs = 30\nfailed_logins_per_minute = 1000\n"
        "[[device]]\nid = \"sim:cameo4\"\ntime_scale = 2\n"
        "[[device]]\nid = \"sim:portrait3\"\ntime_scale = 0\nfaults = \"{}\"\n"
        "[[device]]\nid = \"serial:/dev/popcut-nowhere\"\nmachine = \"hpgl-generic\"\n",
        (files_ / "faults.json").string());
  }
  WireResponse ask(const ContractCall& call) { return caller_->ask(call); }
  json job(const std::string& id) { return caller_->get("/v1/jobs/{id}", {{"id", id}}); }
  json job_in(const std::string& id, const std::string& state);
  std::string new_job(const json& wish);
  int act(const std::string& id, const std::string& action, const json& body = json::object());
  int queue(const std::string& action, const std::string& id);
  ContractCall on_device(const std::string& device, const std::string& action);
  std::string test_cut(const std::string& device);
  std::string new_token(const std::string& role);
  json plan_until(const json& body, const std::string& state);

  TempFolder files_;
  DaemonProcess daemon_;
  FaultPage page_;
  std::optional<ContractCaller> caller_;
  std::uint16_t port_{};
  std::string viewer_, admin_;
  std::string design_, spare_design_, plan_, failed_plan_;
  std::string done_, ready_;  ///< jobs
};

std::string Life::new_token(const std::string& role) {
  const WireResponse made = ask({.method = "POST",
                                 .route = "/v1/tokens",
                                 .body = json{{"name", role}, {"role", role}}.dump()});
  REQUIRE(made.status == 201);
  return json::parse(made.body).at("token");
}

// The job in that state, within two minutes.
json Life::job_in(const std::string& id, const std::string& state) {
  const auto until = std::chrono::steady_clock::now() + std::chrono::minutes(2);
  while (true) {
    json now = job(id);
    if (now.at("state") == state || std::chrono::steady_clock::now() > until) {
      INFO(now.dump());
      CHECK(now.at("state") == state);
      return now;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

std::string Life::new_job(const json& wish) {
  const WireResponse made = ask({.method = "POST", .route = "/v1/jobs", .body = wish.dump()});
  REQUIRE(made.status == 201);
  return json::parse(made.body).at("id");
}

int Life::act(const std::string& id, const std::string& action, const json& body) {
  return ask({.method = "POST",
              .route = "/v1/jobs/{id}/actions/" + action,
              .holes = {{"id", id}},
              .match = quoted(job(id).at("rev")),
              .body = body.dump()})
      .status;
}

int Life::queue(const std::string& action, const std::string& id) {
  return ask({.method = "POST",
              .route = "/v1/queue/actions/" + action,
              .match = quoted(job(id).at("rev")),
              .body = json{{"job", id}}.dump()})
      .status;
}

ContractCall Life::on_device(const std::string& device, const std::string& action) {
  const json now = caller_->get("/v1/devices/{id}", {{"id", device}});
  return {.method = "POST",
          .route = "/v1/devices/{id}/actions/" + action,
          .holes = {{"id", device}},
          .match = quoted(now.at("rev"))};
}

// The job that the test cut of a device makes, ready. The device may change meanwhile.
std::string Life::test_cut(const std::string& device) {
  WireResponse made;
  for (int k = 0; k < 100 && made.status != 200; ++k) made = ask(on_device(device, "test-cut"));
  REQUIRE(made.status == 200);
  const std::string id = json::parse(made.body).at("test_job");
  CHECK(made.headers.at("location") == "/v1/jobs/" + id);
  job_in(id, "ready");
  return id;
}

json Life::plan_until(const json& body, const std::string& state) {
  const WireResponse begun = ask({.method = "POST",
                                  .route = "/v1/designs/{id}/plan",
                                  .holes = {{"id", design_}},
                                  .body = body.dump()});
  REQUIRE(begun.status == 202);
  const std::string id = json::parse(begun.body).at("id");
  const auto until = std::chrono::steady_clock::now() + std::chrono::minutes(2);
  while (true) {
    json now = caller_->get("/v1/plans/{id}", {{"id", id}});
    if (now.at("state") == state || std::chrono::steady_clock::now() > until) {
      CHECK(now.at("state") == state);
      return now;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

void Life::make_design_and_plans() {
  const std::string sphere = text_of(POPCUT_SOURCE_DIR "/examples/sphere.json");
  const auto upload = [&](const std::string& bytes, int status) {
    const WireResponse stored =
        ask({.method = "POST", .route = "/v1/designs", .query = "?name=ball", .body = bytes});
    CHECK(stored.status == status);
    return json::parse(stored.body).value("id", "");
  };
  design_ = upload(sphere, 201);
  CHECK(upload(sphere, 200) == design_);
  upload("{", 422);
  spare_design_ = upload(sphere + " ", 201);
  for (const int status : {201, 200})
    CHECK(ask({.method = "POST", .route = "/v1/assets", .body = "solid a\nendsolid a\n"}).status ==
          status);
  plan_ = plan_until({{"material", "paper-220"}}, "planned").at("id");
  failed_plan_ = plan_until({{"options", {{"mat", "10x10"}}}}, "failed").at("id");
  CHECK(caller_->get("/v1/plans/{id}", {{"id", plan_}}).at("length_mm") > 0);
}

// What is refused before anything is done, at each route.
void Life::knock() {
  for (const ContractCall& call : all_calls(*caller_)) {
    CAPTURE(call.method, call.route);
    const auto refused = [&](int status, ContractCall with) {
      if (!documents(*caller_, call, status)) return;
      CAPTURE(status);
      CHECK(ask(with).status == status);
    };
    const auto changed = [&](const std::function<void(ContractCall&)>& change) {
      ContractCall other = call;
      change(other);
      return other;
    };
    refused(400, changed([](ContractCall& c) { c.query = "%zz"; }));
    refused(413, changed([](ContractCall& c) {
              c.more += "Content-Length: 999999999999\r\n";
              c.body = "";
            }));
    refused(415, changed([](ContractCall& c) {
              c.more += "Content-Type: text/plain\r\n";
              c.body = "{ }";
            }));
    refused(422, changed([](ContractCall& c) { c.query = "?no-such-name=1"; }));
    refused(428, changed([](ContractCall& c) { c.matched = false; }));
    const bool is_session = call.route == "/v1/session";
    if (call.holes.at("id") != "" && !is_session) refused(404, call);
    CHECK(caller_->ask_tcp(call, port_, admin_, "evil.example").status == 421);
    if (call.route == "/healthz" || call.route == "/readyz") continue;
    if (call.method == "POST" && is_session)
      CHECK(ask(call).status == 401);
    else
      CHECK(caller_->ask_tcp(call, port_, "").status == 401);
    if (!documents(*caller_, call, 403)) continue;
    const bool viewer_may = caller_->operation(call).at("x-popcut-role") == "viewer" || is_session;
    const ContractCall elsewhere =
        changed([](ContractCall& c) { c.more += "Origin: http://evil.example\r\n"; });
    CHECK(caller_->ask_tcp(viewer_may ? elsewhere : call, port_, viewer_).status == 403);
  }
  // Over the unix socket there is no session to end.
  CHECK(ask({.method = "DELETE", .route = "/v1/session"}).status == 404);
  const auto of_jobs = [&](const std::string& body) {
    return ContractCall{.method = "POST", .route = "/v1/jobs", .body = body};
  };
  CHECK(ask(of_jobs("{")).problem() == "malformed-json");
  ContractCall keyless = of_jobs("{}");
  keyless.keyed = false;
  CHECK(ask(keyless).problem() == "idempotency-key-missing");
  keyless.more = "Idempotency-Key: the-same-key-twice\r\n";
  CHECK(ask(keyless).status == 422);
  keyless.body = R"({"copies": 1})";
  CHECK(ask(keyless).status == 422);
  RawConnection connection(daemon_.socket());
  connection.send("POST /v1/meta HTTP/1.1\r\nHost: a\r\nContent-Length: 0\r\n\r\n");
  const WireResponse method = connection.receive();
  CHECK(method.problem() == "method-not-allowed");
  CHECK(method.headers.at("allow") == "GET, HEAD");
}

void Life::use_devices_and_materials() {
  for (const char* action : {"disable", "enable", "reset"}) {
    const WireResponse done = ask(on_device("sim:portrait3", action));
    CHECK(done.status == 200);
    CHECK(json::parse(done.body).at("enabled") == (std::string(action) != "disable"));
  }
  CHECK(ask(on_device("serial:/dev/popcut-nowhere", "test-cut")).problem() == "device-absent");
  for (const char* action : {"disable", "enable", "reset", "test-cut"}) {
    ContractCall stale = on_device("sim:cameo3", action);
    stale.match = "\"999999\"";
    CHECK(ask(stale).problem() == "stale");
  }
  const auto material = [&](const std::string& method, const std::string& id,
                            const std::string& match) {
    return ContractCall{
        .method = method, .route = "/v1/materials/{id}", .holes = {{"id", id}}, .match = match};
  };
  ContractCall fresh = material("PUT", "mine", "");
  fresh.more = "If-None-Match: *\r\n";
  CHECK(ask(fresh).status == 201);
  CHECK(ask(material("PUT", "mine", "\"1\"")).status == 200);
  CHECK(ask(material("PUT", "mine", "\"1\"")).status == 412);
  CHECK(ask(material("DELETE", "mine", "\"1\"")).status == 412);
  CHECK(ask(material("DELETE", "mine", "\"2\"")).status == 204);
  CHECK(ask(material("DELETE", "paper-220", "\"1\"")).status == 409);
}

void Life::see_a_job_through() {
  done_ = new_job({{"design", design_}, {"name", "ball"}});
  ready_ = new_job({{"plan", plan_}});
  job_in(done_, "ready");
  job_in(ready_, "ready");
  const auto stale = [&](const std::string& method, const std::string& route,
                         const std::string& body = "") {
    ContractCall call{.method = method, .route = route, .holes = {{"id", ready_}}};
    call.match = "\"999999\"";
    if (!body.empty()) call.body = body;
    CAPTURE(method, route);
    CHECK(ask(call).problem() == "stale");
  };
  for (const char* action : {"arm", "disarm", "start", "pause", "resume", "cancel",
                             "confirm-result", "retry-sheet", "skip-sheet", "resume-from"})
    stale("POST", fmt::format("/v1/jobs/{{id}}/actions/{}", action));
  for (const char* action : {"hold", "release", "move"})
    stale("POST", fmt::format("/v1/queue/actions/{}", action), json{{"job", ready_}}.dump());
  stale("PATCH", "/v1/jobs/{id}");
  stale("DELETE", "/v1/jobs/{id}");
  for (const char* action : {"hold", "release", "move"}) CHECK(queue(action, ready_) == 200);
  CHECK(ask({.method = "PATCH",
             .route = "/v1/jobs/{id}",
             .holes = {{"id", ready_}},
             .match = quoted(job(ready_).at("rev"))})
            .status == 200);
  CHECK(ask({.method = "DELETE",
             .route = "/v1/jobs/{id}",
             .holes = {{"id", ready_}},
             .match = quoted(job(ready_).at("rev"))})
            .status == 409);
  CHECK(act(done_, "start") == 409);
  CHECK(act(done_, "arm", {{"sheet", 2}}) == 409);
  CHECK(act(done_, "arm", {{"sheet", 1}}) == 200);
  CHECK(ask(on_device("sim:cameo3", "reset")).status == 409);
  CHECK(act(done_, "disarm") == 200);
  CHECK(act(done_, "arm", {{"sheet", 1}}) == 200);
  CHECK(act(done_, "start", {{"sheet", 1}}) == 200);
  const json done = job_in(done_, "done");
  CHECK(done.at("progress").at("paths_certain") == done.at("progress").at("paths_total"));
  for (const char* action : {"pause", "resume", "cancel", "disarm", "start"})
    CHECK(act(done_, action) == 409);
  for (const char* action : {"arm", "retry-sheet", "skip-sheet"})
    CHECK(act(done_, action, {{"sheet", 1}}) == 409);
  CHECK(act(done_, "confirm-result", {{"sheet", 1}, {"good", true}}) == 409);
  CHECK(act(done_, "resume-from", {{"from_path", 0}, {"registration", "kept"}}) == 409);
  for (const char* action : {"hold", "release", "move"}) CHECK(queue(action, done_) == 409);
  CHECK(ask({.method = "PATCH",
             .route = "/v1/jobs/{id}",
             .holes = {{"id", done_}},
             .match = quoted(done.at("rev"))})
            .status == 409);
  CHECK(ask({.method = "DELETE", .route = "/v1/designs/{id}", .holes = {{"id", design_}}}).status ==
        409);
}

void Life::pause_a_cut() {
  const std::string id = test_cut("sim:cameo4");
  CHECK(act(id, "arm", {{"sheet", 1}}) == 200);
  CHECK(act(id, "start", {{"sheet", 1}}) == 200);
  // A stop must not depend on who looked last.
  const auto any = [&](const std::string& action) {
    return ask({.method = "POST",
                .route = "/v1/jobs/{id}/actions/" + action,
                .holes = {{"id", id}},
                .match = "*",
                .body = "{}"})
        .status;
  };
  CHECK(any("pause") == 200);
  job_in(id, "paused");
  for (const char* action : {"backup", "check"})
    CHECK(ask({.method = "POST", .route = fmt::format("/v1/db/actions/{}", action)}).status == 409);
  CHECK(act(id, "resume") == 200);
  CHECK(any("cancel") == 200);
  job_in(id, "cancelled");
  for (const char* action : {"backup", "check"})
    CHECK(ask({.method = "POST", .route = fmt::format("/v1/db/actions/{}", action)}).status == 200);
}

// The panel cancels a cut; a person judges the sheet, goes on, takes a new one, leaves it out.
void Life::mend_a_sheet() {
  const std::string id = test_cut("sim:portrait3");
  CHECK(act(id, "arm", {{"sheet", 1}}) == 200);
  CHECK(act(id, "start", {{"sheet", 1}}) == 200);
  job_in(id, "interrupted");
  CHECK(act(id, "resume-from", {{"from_path", 0}, {"registration", "kept"}}) == 409);
  CHECK(act(id, "confirm-result", {{"sheet", 1}, {"good", false}}) == 200);
  CHECK(act(id, "resume-from",
            {{"from_path", 0}, {"registration", "re-registered"}, {"i_accept_double_cut", true}}) ==
        200);
  CHECK(act(id, "retry-sheet", {{"sheet", 1}}) == 200);
  CHECK(act(id, "skip-sheet", {{"sheet", 1}}) == 200);
  CHECK(job_in(id, "done").at("outcome") == "done with skipped sheets");
}

void Life::read_everything() {
  for (ContractCall call : all_calls(*caller_)) {
    if (call.method != "GET") continue;
    CAPTURE(call.route);
    for (const auto& [prefix, id] :
         std::map<std::string, std::string>{{"/v1/jobs/", done_},
                                            {"/v1/designs/", design_},
                                            {"/v1/plans/", plan_},
                                            {"/v1/devices/", "sim:cameo3"},
                                            {"/v1/materials/", "paper-220"}})
      if (call.route.starts_with(prefix)) call.holes["id"] = id;
    const WireResponse found = ask(call);
    CHECK(found.status == 200);
    ContractCall head = call;
    head.method = "HEAD";
    const std::string bytes = caller_->request(call, "popcut", "");
    RawConnection connection(daemon_.socket());
    connection.send("HEAD" + bytes.substr(3));
    const WireResponse top = connection.receive(60, true);
    CHECK(top.status == 200);
    CHECK(top.body.empty());
    CHECK(top.headers.at("content-type") == found.headers.at("content-type"));
    if (documents(*caller_, call, 304)) {
      call.more += "If-None-Match: \"other\", " + found.headers.at("etag") + "\r\n";
      CHECK(ask(call).status == 304);
    }
    if (call.route.starts_with("/v1/plans/{id}/")) {
      call.holes["id"] = failed_plan_;
      CHECK(ask(call).status == 409);
    }
    if (!caller_->operation(call).dump().ends_with("cursor")) continue;
  }
  // Pages of one of each list give all of it, in the same order; what is no cursor of it is none.
  for (const char* route : {"/v1/jobs", "/v1/designs", "/v1/devices", "/v1/materials", "/v1/tokens",
                            "/v1/queue", "/v1/jobs/{id}/sheets"}) {
    CAPTURE(route);
    const auto page = [&](const std::string& query) {
      return ask({.method = "GET", .route = route, .holes = {{"id", done_}}, .query = query});
    };
    const json whole = json::parse(page("?limit=200").body).at("items");
    REQUIRE(!whole.empty());
    json pieces = json::array();
    for (std::string query = "?limit=1"; !query.empty() && pieces.size() <= whole.size();) {
      const json part = json::parse(page(query).body);
      for (const json& one : part.at("items")) pieces.push_back(one);
      query = part.at("next_cursor").is_null()
                  ? ""
                  : "?limit=1&cursor=" + part.at("next_cursor").get<std::string>();
    }
    CHECK(pieces == whole);
    for (const char* query : {"?limit=0", "?limit=201", "?limit=x", "?cursor=x", "?cursor=MXpa"})
      CHECK(page(query).status == 422);
  }
}

void Life::open_sessions() {
  const WireResponse word = ask({.method = "POST", .route = "/v1/session/one-shot"});
  REQUIRE(word.status == 201);
  const ContractCall open{.method = "POST", .route = "/v1/session", .body = word.body};
  const WireResponse session = caller_->ask_tcp(open, port_, "");
  REQUIRE(session.status == 201);
  CHECK(caller_->ask_tcp(open, port_, "").status == 401);  // once
  const std::string token = json::parse(session.body).at("token");
  const ContractCall close{.method = "DELETE", .route = "/v1/session"};
  CHECK(caller_->ask_tcp({.method = "GET", .route = "/v1/meta"}, port_, token).status == 200);
  CHECK(caller_->ask_tcp(close, port_, token).status == 204);
  CHECK(caller_->ask_tcp(close, port_, token).status == 401);
  const json first = caller_->get("/v1/tokens").at("items").at(0);
  CHECK(ask({.method = "DELETE", .route = "/v1/tokens/{id}", .holes = {{"id", first.at("id")}}})
            .status == 204);
}

void Life::fill_the_queue() {
  const ContractCall more{
      .method = "POST", .route = "/v1/jobs", .body = json{{"plan", plan_}}.dump()};
  std::vector<std::string> made;
  WireResponse last;
  for (int k = 0; k < 40 && last.status != 503; ++k) {
    last = ask(more);
    if (last.status == 201) made.push_back(json::parse(last.body).at("id"));
  }
  CHECK(last.problem() == "queue-full");
  CHECK(last.headers.at("retry-after") == "60");
  for (const std::string& id : made) {
    CHECK(act(id, "cancel", {{"reason", "room"}}) == 200);
    CHECK(ask({.method = "DELETE",
               .route = "/v1/jobs/{id}",
               .holes = {{"id", id}},
               .match = quoted(job(id).at("rev"))})
              .status == 204);
  }
}

// Nothing that must be written is done on a full disk, and nothing is forgotten by it.
void Life::fill_the_disk() {
  const json before = job(ready_);
  const WireResponse word = ask({.method = "POST", .route = "/v1/session/one-shot"});
  ContractCall fresh{.method = "PUT", .route = "/v1/materials/{id}", .match = ""};
  fresh.holes = {{"id", "kept"}};
  fresh.more = "If-None-Match: *\r\n";
  REQUIRE(ask(fresh).status == 201);
  const std::string token = caller_->get("/v1/tokens").at("items").back().at("id");
  const WireResponse session =
      caller_->ask_tcp({.method = "POST",
                        .route = "/v1/session",
                        .body = ask({.method = "POST", .route = "/v1/session/one-shot"}).body},
                       port_, "");
  const std::string page_token = json::parse(session.body).at("token");
  page_->full_from = page_->disk.load() + 1;
  for (ContractCall call : all_calls(*caller_)) {
    if (!documents(*caller_, call, 507)) continue;
    CAPTURE(call.method, call.route);
    if (call.route.starts_with("/v1/jobs")) call.holes["id"] = ready_;
    if (call.route.starts_with("/v1/jobs")) call.match = quoted(before.at("rev"));
    if (call.method == "DELETE" && call.route == "/v1/jobs/{id}") {
      call.holes["id"] = done_;
      call.match = "";
    }
    if (call.route == "/v1/jobs") call.body = json{{"plan", plan_}}.dump();
    if (call.route.starts_with("/v1/queue")) {
      call.body = json{{"job", ready_}}.dump();
      call.match = "";
    }
    if (call.route.starts_with("/v1/designs/{id}"))
      call.holes["id"] = call.method == "DELETE" ? spare_design_ : design_;
    if (call.route == "/v1/designs") call.body = "{\"popcut\": 1}";
    if (call.route.starts_with("/v1/materials")) call.holes["id"] = "kept";
    if (call.route.starts_with("/v1/tokens/")) call.holes["id"] = token;
    if (call.route.starts_with("/v1/devices/")) {
      const ContractCall now =
          on_device("sim:cameo3", call.route.substr(call.route.rfind('/') + 1));
      call.holes = now.holes;
      call.match = now.match;
    }
    if (call.route == "/v1/session" && call.method == "POST") call.body = word.body;
    const bool ends = call.route == "/v1/session" && call.method == "DELETE";
    const WireResponse full = ends ? caller_->ask_tcp(call, port_, page_token) : ask(call);
    CHECK(full.problem() == "disk-full");
  }
  CHECK(ask({.method = "GET", .route = "/readyz"}).status == 503);
  CHECK(job(ready_) == before);
  page_->full_from = 0;
  const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (ask({.method = "GET", .route = "/readyz"}).status != 200 &&
         std::chrono::steady_clock::now() < until)
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  CHECK(act(ready_, "cancel") == 200);
  // A design whose file is gone is a fault of popcutd's own.
  std::filesystem::remove(daemon_.state() + "/designs/" + design_);
  CHECK(ask({.method = "GET", .route = "/v1/designs/{id}/content", .holes = {{"id", design_}}})
            .status == 500);
  CHECK(ask({.method = "DELETE", .route = "/v1/designs/{id}", .holes = {{"id", spare_design_}}})
            .status == 204);
}

// 429: one request of each principal, and then none for long.
void ask_too_often(ContractCaller::Pair& last, ContractCaller& all) {
  DaemonProcess daemon(POPCUTD_PROGRAM);
  const std::string file = text_of(daemon.config());
  popcut::testing::write_file(daemon.config(), file.substr(0, file.find("rate_per_s")) +
                                                   "rate_per_s = 0.1\nrate_burst = 1\n");
  REQUIRE(daemon.start());
  ContractCaller caller(daemon.socket());
  for (const ContractCall& call : all_calls(caller)) {
    CAPTURE(call.method, call.route);
    WireResponse response;
    for (int k = 0; k < 3 && response.status != 429; ++k) response = caller.ask(call);
    CHECK(response.problem() == "rate");
    CHECK(std::stoi(response.headers.at("retry-after")) >= 1);
    last = {call.route, response.status};
  }
  daemon.signal(SIGTERM);
  CHECK(daemon.wait() == 0);
  all.add(caller);
}

// 503: the disk does not come to an end with a sync, and nobody waits for it for ever.
void wait_for_the_disk(ContractCaller& all) {
  DaemonProcess daemon(POPCUTD_PROGRAM, 0,
                       "connections = 400\nanswer_s = 1\ndesign_answer_s = 1\n");
  FaultPage page((daemon.folder() / "control").string());
  page.calm();
  REQUIRE(daemon.start(page.environment()));
  ContractCaller caller(daemon.socket());
  page->stall = 1;
  RawConnection writer(daemon.socket());
  const ContractCall write{.method = "POST", .route = "/v1/tokens"};
  writer.send(caller.request(write, "popcut", ""));
  REQUIRE(popcut::daemon::comes_true([&] { return page->stalled > 0; }, 60));
  std::vector<std::pair<ContractCall, RawConnection>> waiting;
  for (const ContractCall& call : all_calls(caller)) {
    if (!documents(caller, call, 503)) continue;
    waiting.emplace_back(call, RawConnection(daemon.socket()));
    waiting.back().second.send(caller.request(call, "popcut", ""));
  }
  for (auto& [call, connection] : waiting) {
    CAPTURE(call.method, call.route);
    const WireResponse response = connection.receive(60);
    caller.hold(call, response);
    CHECK(response.problem() == "unavailable");
  }
  page->stall = 0;
  caller.hold(write, writer.receive(60));
  daemon.signal(SIGTERM);
  CHECK(daemon.wait() == 0);
  all.add(caller);
}

// Why a documented status does not come from a popcutd that is sound, or nothing.
std::string excuse(const ContractCaller::Pair& pair) {
  if (pair.second == 500 && pair.first != "GET /v1/designs/{id}/content")
    return "a fault in popcutd itself, which no request causes; http_openapi_test throws one at "
           "each route";
  return {};
}

}  // namespace

TEST_CASE("the real daemon produces every documented answer of every route",
          "[daemon][popcutd][openapi]") {
  Life life;
  life.make_design_and_plans();
  life.knock();
  life.use_devices_and_materials();
  life.see_a_job_through();
  life.pause_a_cut();
  life.mend_a_sheet();
  life.read_everything();
  life.open_sessions();
  life.fill_the_queue();
  life.fill_the_disk();
  CHECK(life.end() == 0);
  ContractCaller& all = life.caller();
  ContractCaller::Pair last;
  ask_too_often(last, all);
  wait_for_the_disk(all);

  for (const ContractCaller::Pair& pair : all.documented()) {
    const bool produced = all.produced().contains(pair);
    const std::string why = excuse(pair);
    INFO(pair.first << " " << pair.second << " is documented; " << why);
    CHECK(produced == why.empty());
  }
  for (int kind = 0; kind <= static_cast<int>(popcut::daemon::ProblemKind::Internal); ++kind) {
    const std::string slug(slug_of(static_cast<popcut::daemon::ProblemKind>(kind)));
    INFO("problem " << slug);
    // One thread does all that has a key, so a second request waits for the first.
    CHECK(all.problems().contains(slug) == (slug != "idempotency-in-progress"));
  }
}
