// SPDX-License-Identifier: MIT
// The real popcutd answers as the description that it serves says: each route and each documented
// status is produced here, or stands in a list with the reason why it cannot be.
#include <csignal>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "daemon/http/api/openapi.hpp"
#include "daemon/model/problem.hpp"
#include "tests/support/api_generator.hpp"
#include "tests/support/contract_life.hpp"
#include "tests/support/paths.hpp"

namespace popcutd_openapi_test {

using namespace popcut::testing;
using nlohmann::json;
using popcut::daemon::RawConnection;
using popcut::daemon::WireResponse;

namespace {

// 429: one request of each principal, and then none for long.
void ask_too_often(ContractCaller& all) {
  DaemonProcess daemon(popcutd_program());
  const std::string file = text_of_file(daemon.config());
  write_file(daemon.config(), file.substr(0, file.find("rate_per_s")) +
                                  "rate_per_s = 0.1\nrate_burst = 1\npreviews_per_s = 0.1\n"
                                  "pictures_per_s = 0.1\n");
  REQUIRE(daemon.start());
  ContractCaller caller(daemon.socket());
  for (const ContractCall& call : all_calls(caller)) {
    CAPTURE(call.method, call.route);
    if (!documents(caller, call, 429)) continue;
    WireResponse response;
    for (int k = 0; k < 3 && response.status != 429; ++k) response = caller.ask(call);
    CHECK(response.problem() == "rate");
    CHECK(std::stoi(response.headers.at("retry-after")) >= 1);
  }
  daemon.signal(SIGTERM);
  CHECK(daemon.wait() == 0);
  all.add(caller);
}

// 503: the disk does not come to an end with a sync, and nobody waits for it for ever.
void wait_for_the_disk(ContractCaller& all) {
  DaemonProcess daemon(popcutd_program(), 0,
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

// 422: each field of each body is read, required if it is documented as that, and no other field is
// taken.
void misspell_bodies(ContractCaller& caller) {
  const json& schemas = caller.document().at("components").at("schemas");
  for (const ContractCall& call : all_calls(caller)) {
    const json content =
        caller.operation(call).value("/requestBody/content"_json_pointer, json::object());
    const std::string schema_of_json =
        content.value("/application~1json/schema/$ref"_json_pointer, std::string());
    if (schema_of_json.empty() || call.route == "/v1/materials/{id}") continue;
    const json& schema = schemas.at(schema_of_json.substr(schema_of_json.rfind('/') + 1));
    const json& example = schema.at("example");
    CAPTURE(call.route);
    const auto refused = [&](const json& body) {
      ContractCall wrong = call;
      wrong.body = body.dump();
      const WireResponse response = caller.ask(wrong);
      CHECK(response.status == 422);
      return response.body;
    };
    for (const auto& [name, ignored] : schema.at("properties").items()) {
      CAPTURE(name);
      json wrong = example, misspelt = example;
      wrong[name] = json::array({json::array()});
      CHECK(refused(wrong).find(fmt::format("\"pointer\":\"/{}\"", name)) != std::string::npos);
      // One letter too many, and the right name is proposed.
      misspelt[name + "x"] = 1;
      const std::string answer = refused(misspelt);
      CHECK(answer.find("unknown_member") != std::string::npos);
      CHECK(answer.find(fmt::format("did you mean /{}?", name)) != std::string::npos);
    }
    for (const std::string name : schema.value("required", json::array())) {
      json without = example;
      without.erase(name);
      CHECK(refused(without).find(fmt::format("\"pointer\":\"/{}\",\"code\":\"missing\"", name)) !=
            std::string::npos);
    }
    CHECK(refused(json::array()).find("must be an object") != std::string::npos);
  }
}

// Why a documented status does not come from a popcutd that is sound, or nothing.
std::string excuse(const ContractCaller::Pair& pair) {
  if (pair.second == 500 && pair.first != "GET /v1/designs/{id}/content")
    return "a fault in popcutd itself, which no request causes; http_handlers_test throws one";
  return {};
}

}  // namespace

TEST_CASE("the daemon produces every documented answer of every route",
          "[daemon][popcutd][openapi][alone]") {
  ContractLife life;
  life.make_design_and_plans();
  life.knock();
  misspell_bodies(life.caller());
  life.use_devices_and_materials();
  life.see_a_job_through();
  life.pause_a_cut();
  life.mend_a_sheet();
  life.finish_searches();
  life.read_everything();
  life.open_sessions();
  life.fill_the_queue();
  life.fill_the_disk();
  ContractCaller& all = life.caller();
  CHECK(all.document() == json::parse(popcut::daemon::http::openapi_json()));
  CHECK(life.end() == 0);
  ask_too_often(all);
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

TEST_CASE("generated requests of each role get only answers that are documented",
          "[daemon][popcutd][openapi]") {
  DaemonProcess daemon(popcutd_program(), 0, "failed_logins_per_minute = 1000\nqueue_jobs = 300\n");
  const bool serves = daemon.start();
  INFO(daemon.log());
  REQUIRE(serves);
  const std::string url = daemon.url();
  const char* const seed = std::getenv("POPCUT_API_SEED");
  const char* const many = std::getenv("POPCUT_API_REQUESTS");
  const int count = many == nullptr ? 800 : std::stoi(many);
  ApiGenerator generator(daemon.socket(),
                         static_cast<std::uint16_t>(std::stoi(url.substr(url.rfind(':') + 1))),
                         seed == nullptr ? 1 : std::stoull(seed));
  generator.run(count);
  for (const auto& [fault, times] : generator.faults()) FAIL_CHECK(times << " x " << fault);
  std::string figures;
  for (const auto& [status, times] : generator.statuses())
    figures += fmt::format(" {}: {}", status, times);
  const std::string summary =
      fmt::format("{} requests;{}; {} routes with a status, {} with a role", count, figures,
                  generator.produced().size(), generator.asked().size());
  if (many != nullptr) WARN(summary);
  INFO(summary);
  // Enough of them come through to mean something.
  CHECK(generator.statuses().at(200) > count / 12);
  CHECK(generator.statuses().at(201) > count / 200);
  CHECK(generator.statuses().at(403) > count / 50);
  CHECK_FALSE(generator.statuses().contains(500));
  daemon.signal(SIGTERM);
  CHECK(daemon.wait() == 0);
}

}  // namespace popcutd_openapi_test
