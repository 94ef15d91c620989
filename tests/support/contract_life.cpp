// SPDX-License-Identifier: MIT
#include "tests/support/contract_life.hpp"
#include "daemon/http/api/page_files.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/paths.hpp"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <functional>
#include <map>
#include <thread>

#include <unistd.h>

#include <fmt/format.h>
#include <catch2/catch.hpp>

namespace popcut::testing {

using daemon::RawConnection;
using daemon::WireResponse;
using nlohmann::json;

ContractLife::ContractLife()
    : daemon_(popcutd_program(), 0, configuration()),
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

int ContractLife::end() {
  daemon_.signal(SIGTERM);
  return daemon_.wait();
}

std::string ContractLife::configuration() {
  write_file(files_ / "faults.json",
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

std::string ContractLife::new_token(const std::string& role) {
  const WireResponse made = ask({.method = "POST",
                                 .route = "/v1/tokens",
                                 .body = json{{"name", role}, {"role", role}}.dump()});
  REQUIRE(made.status == 201);
  return json::parse(made.body).at("token");
}

// The job in that state, within two minutes.
json ContractLife::job_in(const std::string& id, const std::string& state) {
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

std::string ContractLife::new_job(const json& request) {
  const WireResponse made = ask({.method = "POST", .route = "/v1/jobs", .body = request.dump()});
  REQUIRE(made.status == 201);
  return json::parse(made.body).at("id");
}

// A stop must not depend on who looked last.
int ContractLife::act(const std::string& id, const std::string& action, const json& body) {
  const bool stops = action == "pause" || action == "cancel";
  return ask({.method = "POST",
              .route = "/v1/jobs/{id}/actions/" + action,
              .holes = {{"id", id}},
              .match = stops ? "*" : quoted(job(id).at("rev")),
              .body = body.dump()})
      .status;
}

int ContractLife::queue(const std::string& action, const std::string& id) {
  return ask({.method = "POST",
              .route = "/v1/queue/actions/" + action,
              .match = quoted(job(id).at("rev")),
              .body = json{{"job", id}}.dump()})
      .status;
}

ContractCall ContractLife::on_device(const std::string& device, const std::string& action) {
  const json now = caller_->get("/v1/devices/{id}", {{"id", device}});
  return {.method = "POST",
          .route = "/v1/devices/{id}/actions/" + action,
          .holes = {{"id", device}},
          .match = quoted(now.at("rev"))};
}

// The same, asked. The device may change between the look at it and the question.
WireResponse ContractLife::ask_device(const std::string& device, const std::string& action) {
  WireResponse made;
  for (int k = 0; k < 100 && (k == 0 || made.status == 412); ++k)
    made = ask(on_device(device, action));
  return made;
}

// The job that the test cut of a device makes, ready.
std::string ContractLife::test_cut(const std::string& device) {
  const WireResponse made = ask_device(device, "test-cut");
  REQUIRE(made.status == 200);
  const std::string id = json::parse(made.body).at("test_job");
  CHECK(made.headers.at("location") == "/v1/jobs/" + id);
  job_in(id, "ready");
  return id;
}

json ContractLife::plan_until(const json& body, const std::string& state) {
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

// One that a design needs stays; one that none needs goes.
void ContractLife::use_an_asset() {
  const std::string mesh = testing::obj(testing::sphere_mesh(70, 12, 18));
  const auto add = [&](const std::string& bytes) -> std::string {
    return json::parse(ask({.method = "POST", .route = "/v1/assets", .body = bytes}).body).at("id");
  };
  const auto remove = [&](const std::string& id) {
    return ask({.method = "DELETE", .route = "/v1/assets/{id}", .holes = {{"id", id}}});
  };
  used_asset_ = add(mesh);
  spare_asset_ = add("spare");
  const json spec{{"popcut", 1},          {"surface", {{"type", "mesh"}, {"file", used_asset_}}},
                  {"units_per_slice", 5}, {"slices", 8},
                  {"widths_mm", 6},       {"fit", "nearest"}};
  const WireResponse stored = ask({.method = "POST", .route = "/v1/designs", .body = spec.dump()});
  INFO(stored.body);
  REQUIRE(stored.status == 201);
  const std::string design = json::parse(stored.body).at("id");
  look_at(spec);
  const WireResponse kept = remove(used_asset_);
  CHECK(kept.status == 409);
  CHECK(kept.body.find(design) != std::string::npos);
  CHECK(remove(add("of nobody")).status == 204);
}

std::string ContractLife::begin_search(const std::string& asset) {
  const ContractCall search{
      .method = "POST",
      .route = "/v1/assets/{id}/search",
      .holes = {{"id", asset}},
      .body = json{{"effort", 0.01}, {"style", "facets"}, {"up", "z"}, {"mat", "110x110"}}.dump()};
  const WireResponse begun = ask(search);
  REQUIRE(begun.status == 202);
  const std::string id = json::parse(begun.body).at("id");
  CHECK(json::parse(ask(search).body).at("id") == id);
  return id;
}

void ContractLife::wait_for_search(const std::string& id, const std::string& state) {
  const auto until = std::chrono::steady_clock::now() + std::chrono::minutes(15);
  while (true) {
    const json now = caller_->get("/v1/searches/{id}", {{"id", id}});
    if (now.at("state") == state || std::chrono::steady_clock::now() > until) {
      INFO(now.dump().substr(0, 500));
      CHECK(now.at("state") == state);
      return;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

// A search finds cards for a model, and fails for a file that is not one.
void ContractLife::finish_searches() {
  wait_for_search(search_, "found");
  const auto pick = [&](const std::string& search) {
    return ask({.method = "POST",
                .route = "/v1/searches/{id}/cards/{k}/design",
                .holes = {{"id", search}, {"k", "1"}}})
        .status;
  };
  CHECK(pick(search_) == 201);
  CHECK(pick(search_) == 200);
  wait_for_search(failed_search_, "failed");
  CHECK(pick(failed_search_) == 409);
}

/// Moves a shape into place, and lets a newer preview end an older one.
void ContractLife::look_at(const json& spec) {
  const ContractCall place{.method = "POST",
                           .route = "/v1/place",
                           .body = json{{"spec", spec}, {"place", "whole"}}.dump()};
  const WireResponse placed = ask(place);
  INFO(placed.body);
  CHECK(placed.status == 200);
  ContractCall preview{.method = "POST", .route = "/v1/preview"};
  CHECK(ask(preview).status == 200);
  preview.more = "Preview-Key: one-page-of-a-test\r\n";
  preview.body = json{{"spec", json::parse(placed.body).at("spec")}, {"quality", "exact"}}.dump();
  auto older = std::make_unique<RawConnection>(daemon_.socket());
  older->send(caller_->request(preview, "popcut", ""));
  // The older one is at work or waits; either way it gets an answer.
  for (int k = 0; k < 20 && caller_->problems().count("superseded") == 0; ++k) {
    auto newer = std::make_unique<RawConnection>(daemon_.socket());
    newer->send(caller_->request(preview, "popcut", ""));
    const WireResponse answer = older->receive(60);
    caller_->hold(preview, answer);
    older = std::move(newer);
  }
}

void ContractLife::make_design_and_plans() {
  const std::string sphere = text_of_file(source_file("examples/sphere.json"));
  const auto upload = [&](const std::string& bytes, int status) {
    const WireResponse stored =
        ask({.method = "POST", .route = "/v1/designs", .query = "?name=ball", .body = bytes});
    CHECK(stored.status == status);
    return json::parse(stored.body).value("id", "");
  };
  design_ = upload(sphere, 201);
  CHECK(upload(sphere, 200) == design_);
  upload("{", 422);
  ask({.method = "POST",
       .route = "/v1/designs/{id}/make",
       .holes = {{"id", design_}},
       .body = R"({"way": "silhouette", "options": {"mat": "A4"}})"});
  spare_design_ = upload(sphere + " ", 201);
  for (const int status : {201, 200})
    CHECK(ask({.method = "POST",
               .route = "/v1/assets",
               .query = "?name=a.stl",
               .body = "solid a\nendsolid a\n"})
              .status == status);
  CHECK(caller_->get("/v1/assets").at("items").at(0).at("name") == "a.stl");
  use_an_asset();
  // They compute while other routes are called; see `finish_searches`.
  search_ = begin_search(used_asset_);
  failed_search_ = begin_search(spare_asset_);
  plan_ = plan_until({{"material", "paper-220"}}, "planned").at("id");
  failed_plan_ = plan_until({{"options", {{"mat", "10x10"}}}}, "failed").at("id");
  CHECK(caller_->get("/v1/plans/{id}", {{"id", plan_}}).at("length_mm") > 0);
}

// What is refused before anything is done, at each route.
void ContractLife::knock() {
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
    const bool has_body = caller_->operation(call).contains("requestBody");
    refused(413, changed([&](ContractCall& c) {
              c.more += has_body ? "Content-Length: 999999999999\r\n"
                                 : "X-Filler: " + std::string(9000, 'x') + "\r\n";
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
    const json& role = caller_->operation(call).at("x-popcut-role");
    if (call.method == "POST" && is_session)
      CHECK(ask(call).status == 401);
    else if (role != "everyone")
      CHECK(caller_->ask_tcp(call, port_, "").status == 401);
    if (!documents(*caller_, call, 403)) continue;
    const bool viewer_may = role == "viewer" || role == "everyone" || is_session;
    const ContractCall elsewhere =
        changed([](ContractCall& c) { c.more += "Origin: http://evil.example\r\n"; });
    if (viewer_may && call.method == "GET") {
      // Each token may read; a user of the socket may have no role.
      if (auto nobody = RawConnection::as_user(65534, daemon_.socket())) {
        nobody->send(caller_->request(call, "popcut", ""));
        const WireResponse response = nobody->receive();
        caller_->hold(call, response);
        CHECK(response.status == 403);
      }
      continue;
    }
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
  keyless.body = json{{"design", "sha256-" + std::string(64, '0')}}.dump();
  CHECK(ask(keyless).problem() == "validation");
  CHECK(ask(keyless).headers.at("idempotent-replayed") == "true");
  keyless.body = json{{"design", design_}}.dump();
  CHECK(ask(keyless).problem() == "idempotency-key-reused");
  RawConnection connection(daemon_.socket());
  connection.send("POST /v1/meta HTTP/1.1\r\nHost: a\r\nContent-Length: 0\r\n\r\n");
  const WireResponse method = connection.receive();
  CHECK(method.problem() == "method-not-allowed");
  caller_->note(method);
  CHECK(method.headers.at("allow") == "GET, HEAD");
}

void ContractLife::use_devices_and_materials() {
  for (const char* action : {"disable", "enable", "reset"}) {
    const WireResponse done = ask_device("sim:portrait3", action);
    CHECK(done.status == 200);
    CHECK(json::parse(done.body).at("enabled") == (std::string(action) != "disable"));
  }
  CHECK(ask_device("serial:/dev/popcut-nowhere", "test-cut").problem() == "device-absent");
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

void ContractLife::see_a_job_through() {
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
  CHECK(ask_device("sim:cameo3", "reset").status == 409);
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
  for (const auto& [route, id] :
       {std::pair{"/v1/designs/{id}", design_}, {"/v1/plans/{id}", plan_}})
    CHECK(ask({.method = "DELETE", .route = route, .holes = {{"id", id}}}).status == 409);
}

void ContractLife::pause_a_cut() {
  const std::string id = test_cut("sim:cameo4");
  CHECK(act(id, "arm", {{"sheet", 1}}) == 200);
  CHECK(act(id, "start", {{"sheet", 1}}) == 200);
  CHECK(act(id, "pause") == 200);
  job_in(id, "paused");
  for (const char* action : {"backup", "check"})
    CHECK(ask({.method = "POST", .route = fmt::format("/v1/db/actions/{}", action)}).status == 409);
  CHECK(act(id, "resume") == 200);
  CHECK(act(id, "cancel") == 200);
  job_in(id, "cancelled");
  for (const char* action : {"backup", "check"})
    CHECK(ask({.method = "POST", .route = fmt::format("/v1/db/actions/{}", action)}).status == 200);
}

// The panel cancels a cut; a person judges the sheet, goes on, takes a new one, leaves it out.
void ContractLife::mend_a_sheet() {
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

void ContractLife::read_everything() {
  for (ContractCall call : all_calls(*caller_)) {
    if (call.method != "GET") continue;
    CAPTURE(call.route);
    for (const auto& [prefix, id] :
         std::map<std::string, std::string>{{"/v1/jobs/", done_},
                                            {"/v1/designs/", design_},
                                            {"/v1/plans/", plan_},
                                            {"/v1/searches/", search_},
                                            {"/v1/devices/", "sim:cameo3"},
                                            {"/v1/materials/", "paper-220"}})
      if (call.route.starts_with(prefix)) call.holes["id"] = id;
    call.holes["file"] = daemon::http::page_files().back().name;
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
    if (call.route.starts_with("/v1/searches/{id}/")) {
      call.holes["id"] = failed_search_;
      CHECK(ask(call).status == 409);
    }
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

json ContractLife::new_session() {
  const WireResponse word = ask({.method = "POST", .route = "/v1/session/one-shot"});
  const WireResponse session =
      caller_->ask_tcp({.method = "POST", .route = "/v1/session", .body = word.body}, port_, "");
  REQUIRE(session.status == 201);
  return json::parse(session.body);
}

void ContractLife::open_sessions() {
  const WireResponse word = ask({.method = "POST", .route = "/v1/session/one-shot"});
  REQUIRE(word.status == 201);
  const ContractCall enter{.method = "POST", .route = "/v1/session", .body = word.body};
  const WireResponse session = caller_->ask_tcp(enter, port_, "");
  REQUIRE(session.status == 201);
  CHECK(caller_->ask_tcp(enter, port_, "").status == 401);  // once
  const std::string token = json::parse(session.body).at("token");
  const ContractCall close{.method = "DELETE", .route = "/v1/session"};
  CHECK(caller_->ask_tcp({.method = "GET", .route = "/v1/meta"}, port_, token).status == 200);
  const json open = caller_->get("/v1/sessions").at("items");
  REQUIRE(open.size() == 1);
  CHECK(open.at(0).at("id") == json::parse(session.body).at("id"));
  CHECK(open.at(0).at("root") == fmt::format("uid:{}", ::geteuid()));
  CHECK(caller_->ask_tcp(close, port_, token).status == 204);
  const auto end = [&](const std::string& id) {
    return ask({.method = "DELETE", .route = "/v1/sessions/{id}", .holes = {{"id", id}}}).status;
  };
  CHECK(end(new_session().at("id")) == 204);
  const json secret = let_in();
  const ContractCall collect{
      .method = "POST", .route = "/v1/session/pair/collect", .body = secret.dump()};
  const WireResponse tablet = ask(collect);
  REQUIRE(tablet.status == 201);
  CHECK(ask(collect).status == 404);
  CHECK(caller_->ask_tcp(close, port_, json::parse(tablet.body).at("token")).status == 204);
  CHECK(caller_->ask_tcp(close, port_, token).status == 401);
  const json first = caller_->get("/v1/tokens").at("items").at(0);
  CHECK(ask({.method = "DELETE", .route = "/v1/tokens/{id}", .holes = {{"id", first.at("id")}}})
            .status == 204);
}

json ContractLife::let_in() {
  const auto pair = [&](const std::string& last, const json& body) {
    return ask({.method = "POST", .route = "/v1/session/pair" + last, .body = body.dump()});
  };
  const json asked = json::parse(pair("", {{"name", "tablet"}}).body);
  const json secret{{"secret", asked.at("secret")}};
  CHECK(pair("/collect", secret).status == 202);
  CHECK(pair("/allow", {{"code", asked.at("code")}, {"role", "viewer"}}).status == 200);
  return secret;
}

}  // namespace popcut::testing
