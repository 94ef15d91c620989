// SPDX-License-Identifier: MIT
// Part of tests/support/contract_life.hpp: answers when the queue or the disk is full.
#include <chrono>
#include <filesystem>
#include <thread>

#include <catch2/catch.hpp>

#include "tests/support/contract_life.hpp"

namespace popcut::testing {

using daemon::WireResponse;
using nlohmann::json;

void ContractLife::fill_the_queue() {
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
void ContractLife::fill_the_disk() {
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
  const std::string page_id = new_session().at("id");
  const json tablet = let_in();
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
    if (call.route == "/v1/plans/{id}") call.holes["id"] = failed_plan_;
    if (call.route == "/v1/designs") call.body = "{\"popcut\": 1}";
    if (call.route.starts_with("/v1/materials")) call.holes["id"] = "kept";
    if (call.route.starts_with("/v1/tokens/")) call.holes["id"] = token;
    if (call.route.starts_with("/v1/sessions/")) call.holes["id"] = page_id;
    if (call.route.starts_with("/v1/assets/")) call.holes["id"] = spare_asset_;
    if (call.route.starts_with("/v1/searches/")) call.holes["id"] = search_;
    if (call.route.starts_with("/v1/devices/")) {
      const ContractCall now =
          on_device("sim:cameo3", call.route.substr(call.route.rfind('/') + 1));
      call.holes = now.holes;
      call.match = now.match;
    }
    if (call.route == "/v1/session" && call.method == "POST") call.body = word.body;
    if (call.route == "/v1/session/pair/collect") call.body = tablet.dump();
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
  for (const auto& [route, id] :
       {std::pair{"/v1/plans/{id}", failed_plan_}, {"/v1/searches/{id}", search_}})
    CHECK(ask({.method = "DELETE", .route = route, .holes = {{"id", id}}}).status == 204);
}

}  // namespace popcut::testing
