// SPDX-License-Identifier: MIT
// Handlers without sockets, over the fake service.
#include <algorithm>

#include <fmt/format.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "core/design/spec/spec.hpp"
#include "daemon/examples/examples.hpp"
#include "daemon/http/api/dispatch.hpp"
#include "daemon/http/api/handler_kit.hpp"
#include "daemon/http/api/render.hpp"
#include "daemon/http/api/target.hpp"
#include "daemon/model/wall_clock.hpp"
#include "tests/support/fake_service.hpp"

namespace http_handlers_test {

using namespace popcut::daemon;
using namespace popcut::daemon::http;
using nlohmann::json;

namespace {

struct Asked {
  Response response;
  json body;
};

Asked ask(FakeService& fake, Method method, const std::string& target,
          std::vector<Header> headers = {}, const std::string& body = "",
          Principal principal = {"token:admin", Role::Admin}) {
  const Answer<Target> parts = read_target(target);
  REQUIRE(parts);
  const Match match = find_route(method, parts->segments);
  REQUIRE(match.route != nullptr);
  Request request;
  request.method = method;
  request.target = target;
  request.id = "01JREQUEST";
  request.params = match.params;
  request.query = parts->query;
  request.usual_page_items = match.route->usual_page_items;
  request.headers = std::move(headers);
  request.body = body;
  request.principal = std::move(principal);
  Asked out;
  bool answered = false;
  const Reply reply([&](Response response) {
    out.response = std::move(response);
    answered = true;
  });
  const HandlerContext context;
  dispatch(request, *match.route, fake, context, reply);
  REQUIRE(answered);
  if (out.response.make_body) out.response.body = out.response.make_body();
  out.body = json::parse(out.response.body, nullptr, false);
  return out;
}

std::vector<Header> keyed(const std::string& if_match = "") {
  static int number = 0;
  std::vector<Header> out{{"idempotency-key", fmt::format("handler-test-{:06}", ++number)}};
  if (!if_match.empty()) out.push_back({"if-match", if_match});
  return out;
}

const Principal kSubmitter{"token:submitter", Role::Submitter};
const Principal kOperator{"token:operator", Role::Operator};

}  // namespace

TEST_CASE("each route has a handler and is found by its path", "[daemon][http][routes]") {
  CHECK(routes().size() > 50);
  for (const Route& route : routes()) {
    CAPTURE(route.path);
    CHECK(route.handler != nullptr);
    std::vector<std::string> segments =
        read_target(route.path.find('{') == std::string_view::npos ? route.path
                                                                   : std::string_view("/"))
            ->segments;
    if (segments.size() > 1) CHECK(find_route(route.method, segments).route == &route);
  }
  CHECK(allow_header(find_route(Method::Options, {"v1", "jobs", "x"}).allowed) ==
        "GET, HEAD, PATCH, DELETE");
  CHECK(find_route(Method::Get, {"v1", "jobs", ""}).route == nullptr);
  CHECK(find_route(Method::Get, {"v1", "plans", "p", "sheets", ".svg"}).route == nullptr);
  CHECK(find_route(Method::Get, {"v1", "plans", "p", "sheets", "7.svg"}).params ==
        std::vector<std::string>{"p", "7"});
}

TEST_CASE("the tables that a page chooses from are those of the command line",
          "[daemon][http][handlers]") {
  FakeService fake;
  const Asked examples = ask(fake, Method::Get, "/v1/examples");
  REQUIRE(examples.response.status == 200);
  CHECK(examples.body.at("items").size() == popcut::examples().size());
  CHECK(examples.body.at("next_cursor").is_null());
  for (const json& item : examples.body.at("items")) {
    CAPTURE(item.at("name"));
    CHECK_FALSE(item.at("title").get<std::string>().empty());
    CHECK(popcut::parse_design_spec(item.at("spec").dump()));
  }
  const Asked schema = ask(fake, Method::Get, "/v1/design-schema");
  CHECK(schema.response.body == popcut::design_spec_schema());
  for (const Asked* fixed : {&examples, &schema}) {
    const std::string etag = fixed->response.headers.at(0).value;
    CHECK(ask(fake, Method::Get, fixed == &examples ? "/v1/examples" : "/v1/design-schema",
              {{"if-none-match", etag}})
              .response.status == 304);
  }
  const Asked machines = ask(fake, Method::Get, "/v1/machines");
  CHECK(machines.body.at("items").size() == popcut::all_machines()->size());
  CHECK(machines.body.at("items").at(0).at("mats").is_array());
}

TEST_CASE("the strokes of a sheet are a file of its plan", "[daemon][http][handlers]") {
  FakeService fake;
  fake.files["p/sheet-01.strokes.json"] = "/nowhere.json";
  const auto strokes = [&](const std::string& sheet, std::vector<Header> headers = {}) {
    return ask(fake, Method::Get, "/v1/plans/p/sheets/" + sheet + "/strokes", std::move(headers))
        .response;
  };
  const Response first = strokes("1");
  CHECK(first.status == 200);
  CHECK(first.file == "/nowhere.json");
  CHECK(first.headers.at(0).value == "\"p-1-strokes\"");
  CHECK(strokes("1", {{"if-none-match", "\"p-1-strokes\""}}).status == 304);
  CHECK(strokes("1", {{"if-none-match", "\"p-1-strokes\""}}).file.empty());
  for (const char* sheet : {"2", "0", "-1", "01", "x", "99999999999999999999"})
    CHECK(strokes(sheet).status == 404);
}

TEST_CASE("meta names who asks and whether a session does", "[daemon][http][handlers]") {
  FakeService fake;
  const auto meta = [&](const Principal& who) {
    return ask(fake, Method::Get, "/v1/meta", {}, "", who).body;
  };
  const json token = meta({.name = "token:viewer", .role = Role::Viewer, .credential = "x"});
  CHECK(token.at("principal").at("title") == "viewer's");
  CHECK(token.at("session") == false);
  CHECK(
      meta({.name = "token:viewer", .role = Role::Viewer, .credential = "viewer"}).at("session") ==
      true);
  const auto now = time_from(token.at("now").get<std::string>());
  REQUIRE(now);
  CHECK(std::abs(*now - popcut::daemon::wall_clock_ms()) < 60'000);
}

TEST_CASE("every member of a job request reaches the service", "[daemon][http][handlers]") {
  FakeService fake;
  const Asked asked = ask(fake, Method::Post, "/v1/jobs", keyed(), R"({
    "plan": "01JD", "material": "paper-220", "device": "sim:cameo3", "site": "hall", "copies": 3, "priority": -2,
    "name": "Karte \u00e4", "note": "a\nb", "tags": ["x", "y"], "on_sheet_done": "wait",
    "options": {"order": "best", "effort": 2}})",
                          kSubmitter);
  REQUIRE(asked.response.status == 201);
  const JobCreate& request = fake.last_create;
  CHECK(request.plan == "01JD");
  CHECK(request.design.empty());
  CHECK(request.material == "paper-220");
  CHECK(request.device == "sim:cameo3");
  CHECK(request.site == "hall");
  CHECK(request.copies == 3);
  CHECK(request.priority == -2);
  CHECK(request.name == "Karte \xC3\xA4");
  CHECK(request.note == "a\nb");
  CHECK(request.tags == std::vector<std::string>{"x", "y"});
  CHECK(request.options.at("effort") == "2");
  CHECK(asked.body.at("owner") == "token:submitter");
  CHECK(asked.body.at("sheet") == 1);
  CHECK(asked.body.at("started").is_null());
}

TEST_CASE("the members of each action reach the service", "[daemon][http][handlers]") {
  FakeService fake;
  const std::string id = fake.add_job(JobState::Interrupted, "token:submitter").id;
  const auto act = [&](const std::string& action, const std::string& body) {
    const std::string etag = fmt::format("\"{}\"", fake.job_map.at(id).rev);
    fake.job_map.at(id).state = JobState::Interrupted;
    const Asked asked = ask(fake, Method::Post, "/v1/jobs/" + id + "/actions/" + action,
                            keyed(etag), body, kOperator);
    CAPTURE(action, asked.response.body);
    CHECK(asked.response.status == 200);
    return fake.last_action;
  };
  const ActionRequest arm =
      act("arm", R"({"sheet":2,"blank":3,"device":"sim:cameo3","plan_sha256":"ab"})");
  CHECK(arm.action == JobAction::Arm);
  CHECK(arm.sheet == 2);
  CHECK(arm.blank == 3);
  CHECK(arm.device == "sim:cameo3");
  CHECK(arm.plan_sha256 == "ab");
  CHECK(act("start", "{}").action == JobAction::Start);
  CHECK(act("pause", "").action == JobAction::Pause);
  CHECK(act("resume", "{}").action == JobAction::Resume);
  CHECK(act("disarm", "{}").action == JobAction::Disarm);
  CHECK(act("cancel", R"({"reason":"wrong paper"})").reason == "wrong paper");
  const ActionRequest confirm = act("confirm-result", R"({"sheet":1,"good":false})");
  CHECK(confirm.action == JobAction::ConfirmResult);
  CHECK(confirm.good == false);
  CHECK(act("retry-sheet", R"({"sheet":1})").action == JobAction::RetrySheet);
  CHECK(act("skip-sheet", R"({"sheet":1})").action == JobAction::SkipSheet);
  const ActionRequest resume = act(
      "resume-from",
      R"({"from_path":7,"registration":"re-registered","i_accept_double_cut":true,"skip_in_doubt":true})");
  CHECK(resume.from_path == 7);
  CHECK(resume.registration == "re-registered");
  CHECK(resume.accept_double_cut);
  CHECK(resume.skip_in_doubt);
}

TEST_CASE("starting a knife requires the revision that the client saw",
          "[daemon][http][handlers]") {
  FakeService fake;
  const std::string id = fake.add_job(JobState::Armed, "token:submitter").id;
  const std::string start = "/v1/jobs/" + id + "/actions/start";
  CHECK(ask(fake, Method::Post, start, keyed(), "{}").response.status == 428);
  for (const char* bad : {"*", "1", "W/\"1\"", "\"\"", "\"x\"", "\"1\", \"2\"", "\"-1\"", "\"1"}) {
    CAPTURE(bad);
    CHECK(ask(fake, Method::Post, start, keyed(bad), "{}").response.status == 400);
  }
  const Asked stale = ask(fake, Method::Post, start, keyed("\"7\""), "{}");
  CHECK(stale.response.status == 412);
  CHECK(stale.body.at("rev") == 1);
  CHECK(stale.body.at("state") == "armed");
  CHECK(ask(fake, Method::Post, start, keyed("\"1\""), "{}").response.status == 200);
}

TEST_CASE("submitters may change only their own jobs", "[daemon][http][handlers]") {
  FakeService fake;
  const std::string own = fake.add_job(JobState::Queued, "token:submitter").id;
  const std::string other = fake.add_job(JobState::Queued, "token:someone").id;
  for (const auto& [id, status] : {std::pair{own, 200}, std::pair{other, 403}}) {
    CHECK(ask(fake, Method::Patch, "/v1/jobs/" + id, {{"if-match", "\"1\""}}, R"({"priority":1})",
              kSubmitter)
              .response.status == status);
    CHECK(
        ask(fake, Method::Post, "/v1/jobs/" + id + "/actions/cancel", keyed("*"), "{}", kSubmitter)
            .response.status == status);
  }
  CHECK(ask(fake, Method::Delete, "/v1/jobs/" + other, {}, "", kSubmitter).response.status == 403);
  CHECK(ask(fake, Method::Delete, "/v1/jobs/" + own, {}, "", kSubmitter).response.status == 204);
  CHECK(ask(fake, Method::Delete, "/v1/jobs/" + other, {}, "", kOperator).response.status == 204);
}

TEST_CASE("pages continue where they ended and invented cursors are refused",
          "[daemon][http][handlers]") {
  FakeService fake;
  for (int i = 0; i < 25; ++i) fake.add_job(JobState::Queued, "a");
  std::string cursor;
  std::vector<std::string> ids;
  int pages = 0;
  do {
    const Asked page =
        ask(fake, Method::Get, "/v1/jobs?limit=10" + (cursor.empty() ? "" : "&cursor=" + cursor));
    REQUIRE(page.response.status == 200);
    for (const json& job : page.body.at("items")) ids.push_back(job.at("id"));
    cursor =
        page.body.at("next_cursor").is_null() ? "" : page.body.at("next_cursor").get<std::string>();
    ++pages;
  } while (!cursor.empty() && pages < 10);
  CHECK(pages == 3);
  CHECK(ids.size() == 25);
  CHECK(std::is_sorted(ids.begin(), ids.end()));
  for (const char* bad : {"cursor=x", "cursor=", "limit=0", "limit=201", "limit=1.5", "limit=+1",
                          "limit=", "limit=1e1", "state=armd", "since=yesterday",
                          "since=2026-13-01", "since=2026-02-30", "order=", "order=newest"}) {
    CAPTURE(bad);
    const Asked page = ask(fake, Method::Get, fmt::format("/v1/jobs?{}", bad));
    CHECK(page.response.status == 422);
    CHECK(page.body.at("errors").size() == 1);
  }
}

TEST_CASE("a fault quotes the wrong value but never a secret", "[daemon][http][handlers]") {
  FakeService fake;
  const auto got = [&](const std::string& target, const std::string& body) {
    return ask(fake, Method::Post, target, keyed(), body).body.at("errors").at(0);
  };
  CHECK(got("/v1/jobs", R"({"design":"a","copies":0})").at("got") == 0);
  CHECK(got("/v1/jobs", R"({"design":"a","copies":"x"})").at("got") == "x");
  CHECK(got("/v1/jobs", R"({"design":"a","on_sheet_done":"go"})").at("got") == "go");
  CHECK_FALSE(got("/v1/jobs", R"({"design":"a","copies":[1]})").contains("got"));
  CHECK_FALSE(got("/v1/jobs", R"({"design":"a","copies":")" + std::string(99, 'x') + R"("})")
                  .contains("got"));
  CHECK_FALSE(got("/v1/session", R"({"one_shot":7})").contains("got"));
}

TEST_CASE("a cursor is valid for one list only", "[daemon][http][handlers]") {
  FakeService fake;
  for (int i = 0; i < 3; ++i) fake.add_job(JobState::Queued, "a");
  const std::string cursor =
      ask(fake, Method::Get, "/v1/jobs?limit=1").body.at("next_cursor").get<std::string>();
  for (const char* list :
       {"/v1/queue", "/v1/designs", "/v1/devices", "/v1/materials", "/v1/tokens"}) {
    CAPTURE(list);
    const Asked asked = ask(fake, Method::Get, fmt::format("{}?cursor={}", list, cursor));
    CHECK(asked.response.status == 422);
    CHECK(asked.body.at("errors").at(0).at("pointer") == "?cursor");
    CHECK(ask(fake, Method::Get, fmt::format("{}?limit=200", list)).response.status == 200);
  }
}

TEST_CASE("a hold checks the revision that was sent", "[daemon][http][handlers]") {
  FakeService fake;
  const std::string id = fake.add_job(JobState::Ready, "a").id;
  const std::string body = R"({"job":")" + id + "\"}";
  const Asked stale = ask(fake, Method::Post, "/v1/queue/actions/hold", keyed("\"9\""), body);
  CHECK(stale.response.status == 412);
  CHECK(stale.body.at("rev") == 1);
  CHECK(ask(fake, Method::Post, "/v1/queue/actions/hold", keyed("\"1\""), body).response.status ==
        200);
}

TEST_CASE("a test cut names its material and its job", "[daemon][http][handlers]") {
  FakeService fake;
  const Asked made = ask(fake, Method::Post, "/v1/devices/sim:cameo3/actions/test-cut",
                         keyed("\"1\""), R"({"material":"pp-150"})");
  CHECK(made.response.status == 200);
  CHECK(fake.last_device_request.material == "pp-150");
  CHECK(made.body.contains("test_job"));
  CHECK(ask(fake, Method::Post, "/v1/devices/sim:cameo3/actions/reset", keyed("\"2\""),
            R"({"material":"pp-150"})")
            .response.status == 422);
}

TEST_CASE("lists are filtered by state and owner and time", "[daemon][http][handlers]") {
  FakeService fake;
  const Asked list = ask(
      fake, Method::Get,
      "/v1/jobs?state=ready,armed&owner=uid%3A1000&device=sim:cameo3&since=2026-11-21T10:00:00.5Z");
  CHECK(list.response.status == 200);
  CHECK(fake.last_filter.states == std::vector<JobState>{JobState::Ready, JobState::Armed});
  CHECK(fake.last_filter.owner == "uid:1000");
  CHECK(fake.last_filter.device == "sim:cameo3");
  CHECK(rfc3339(*fake.last_filter.since) == "2026-11-21T10:00:00.500Z");
  CHECK_FALSE(fake.last_filter.newest_first);
  CHECK(ask(fake, Method::Get, "/v1/jobs?order=desc").response.status == 200);
  CHECK(fake.last_filter.newest_first);
  CHECK(ask(fake, Method::Get, "/v1/jobs?order=asc").response.status == 200);
  CHECK_FALSE(fake.last_filter.newest_first);
}

TEST_CASE("times are read and written in RFC 3339", "[daemon][http][time]") {
  CHECK(rfc3339(0) == "1970-01-01T00:00:00.000Z");
  CHECK(rfc3339(-1) == "1969-12-31T23:59:59.999Z");
  CHECK(time_from("1970-01-02") == 86'400'000);
  CHECK(time_from("2026-11-21T11:30:00.123+01:30") == time_from("2026-11-21T10:00:00.123Z"));
  CHECK(time_from("2026-11-21T10:00:00.123456789Z") == time_from("2026-11-21T10:00:00.123Z"));
  CHECK(time_from("2024-02-29").has_value());
  for (const char* bad : {"", "2026", "2026-1-1", "2025-02-29", "2026-11-21T",
                          "2026-11-21 10:00:00Z", "2026-11-21T10:00:00", "2026-11-21T24:00:00Z",
                          "2026-11-21T10:00:00.Z", "2026-11-21T10:00:00+1:00", "2026-11-21Tx",
                          "20261121T100000Z", "+026-11-21", "2026-11-21T10:00:00Zx"}) {
    CAPTURE(bad);
    CHECK_FALSE(time_from(bad).has_value());
  }
}

TEST_CASE("a material is replaced by revision or must be new", "[daemon][http][handlers]") {
  FakeService fake;
  const std::string at = "/v1/materials/card-300", row = R"({"force_gf": 200})";
  CHECK(ask(fake, Method::Put, at, {}, row).response.status == 428);
  CHECK(ask(fake, Method::Put, at, {{"if-match", "\"1\""}, {"if-none-match", "*"}}, row)
            .response.status == 428);
  const Asked made = ask(fake, Method::Put, at, {{"if-none-match", "*"}}, row);
  CHECK(made.response.status == 201);
  CHECK(made.body.at("material").at("force_gf") == 200);
  CHECK(ask(fake, Method::Put, at, {{"if-none-match", "*"}}, row).response.status == 412);
  CHECK(ask(fake, Method::Put, at, {{"if-match", "\"1\""}}, row).response.status == 200);
  CHECK(ask(fake, Method::Put, "/v1/materials/A%20b", {{"if-none-match", "*"}}, row)
            .response.status == 422);
  CHECK(ask(fake, Method::Put, at, {{"if-match", "\"2\""}}, "[]").response.status == 422);
}

TEST_CASE("usage as CSV contains no spreadsheet formulas", "[daemon][http][handlers]") {
  FakeService fake;
  const Asked csv =
      ask(fake, Method::Get, "/v1/usage?by=owner&from=2026-01-01", {{"accept", "text/csv"}});
  CHECK(csv.response.content_type == "text/csv; charset=utf-8");
  CHECK(csv.response.body ==
        "owner,seconds,cut_mm,sheets\r\n\"uid:0\",12.500,340.250,2\r\n"
        "\"'=cmd|' /C calc'!A0\",1.000,2.000,3\r\n");
  CHECK(ask(fake, Method::Get, "/v1/usage").body.at("items").size() == 2);
  CHECK(ask(fake, Method::Get, "/v1/usage?by=shoe").response.status == 422);
}

TEST_CASE("sheets and ledgers are reported as ranges of strokes", "[daemon][http][handlers]") {
  FakeService fake;
  const std::string at = "/v1/jobs/" + fake.add_job(JobState::Interrupted, "a").id + "/sheets";
  CHECK(ask(fake, Method::Get, at).body.at("items").size() == 2);
  CHECK(ask(fake, Method::Get, at + "/2").body.at("sheet") == 2);
  for (const char* bad : {"/3", "/0", "/-1", "/01", "/x", "/9999999"})
    CHECK(ask(fake, Method::Get, at + bad).response.status == 404);
  const json ledger = ask(fake, Method::Get, at + "/1/ledger").body;
  CHECK(ledger.at("in_doubt") == json::parse("[[5,6]]"));
  CHECK(ledger.at("certain_upto") == 4);
}

TEST_CASE("the program of a sheet is found in either language", "[daemon][http][handlers]") {
  FakeService fake;
  fake.files["P/sheet-01.gpgl"] = "/a";
  fake.files["P/sheet-12.hpgl"] = "/b";
  CHECK(ask(fake, Method::Get, "/v1/plans/P/sheets/1/program").response.file == "/a");
  CHECK(ask(fake, Method::Get, "/v1/plans/P/sheets/12/program").response.file == "/b");
  CHECK(ask(fake, Method::Get, "/v1/plans/P/sheets/2/program").response.status == 404);
}

TEST_CASE("a preview reaches the service with its spec, quality and key",
          "[daemon][http][handlers]") {
  FakeService fake;
  const std::vector<Header> key{{"preview-key", "page-0123456789abc"}};
  const Asked drawn = ask(fake, Method::Post, "/v1/preview", key,
                          R"({"spec": {"popcut": 1, "slices": 3}, "quality": "draft"})");
  CHECK(drawn.response.status == 200);
  CHECK(drawn.response.content_type == "application/vnd.popcut.lattice");
  CHECK(drawn.response.body == "PCLB");
  CHECK(json::parse(fake.last_preview.spec) == json{{"popcut", 1}, {"slices", 3}});
  CHECK(fake.last_preview.is_draft);
  CHECK(fake.last_preview.key == "page-0123456789abc");
  CHECK(fake.last_preview.place.empty());
  CHECK(ask(fake, Method::Post, "/v1/preview", {},
            R"({"spec": {}, "quality": "exact", "place": "quarter"})")
            .response.status == 200);
  CHECK_FALSE(fake.last_preview.is_draft);
  CHECK(fake.last_preview.place == "quarter");
  const struct {
    const char* body;
    const char* pointer;
  } wrong[] = {{R"({"quality": "draft"})", "/spec"},
               {R"({"spec": "x", "quality": "draft"})", "/spec"},
               {R"({"spec": {}})", "/quality"},
               {R"({"spec": {}, "quality": "best"})", "/quality"},
               {R"({"spec": {}, "quality": "draft", "place": "left"})", "/place"},
               {R"({"spec": {}, "quality": "draft", "key": 1})", "/key"}};
  for (const auto& one : wrong) {
    CAPTURE(one.body);
    const Asked refused = ask(fake, Method::Post, "/v1/preview", key, one.body);
    CHECK(refused.response.status == 422);
    CHECK(refused.body["errors"][0]["pointer"] == one.pointer);
  }
  for (const char* bad : {"short", "has a blank in it 123456"})
    CHECK(ask(fake, Method::Post, "/v1/preview", {{"preview-key", bad}},
              R"({"spec": {}, "quality": "draft"})")
              .response.status == 400);
  fake.next_problem = Problem{ProblemKind::Superseded, "a newer one came"};
  const Asked older =
      ask(fake, Method::Post, "/v1/preview", key, R"({"spec": {}, "quality": "draft"})");
  CHECK(older.response.status == 409);
  CHECK(older.body["type"] == "https://popcut.invalid/p/superseded");
}

TEST_CASE("the sheets of a design come as they were made, and a question as data",
          "[daemon][http][handlers]") {
  FakeService fake;
  const char* path = "/v1/designs/sha256-1/make";
  CHECK(ask(fake, Method::Post, path, {}, R"({"way": "hand"})").response.status == 404);
  fake.design_map["sha256-1"].id = "sha256-1";
  const Asked made =
      ask(fake, Method::Post, path, {}, R"({"way": "hand", "options": {"mat": "A4"}})");
  CHECK(made.response.status == 200);
  CHECK(made.body == json{{"way", "hand"}, {"design", "sha256-1"}});
  for (const char* wrong : {"{}", R"({"way": "glue"})", R"({"way": "hand", "mat": "A4"})"})
    CHECK(ask(fake, Method::Post, path, {}, wrong).response.status == 422);
  Problem unclear{ProblemKind::Validation, "say it"};
  unclear.asks = R"({"asks": "colors", "looks": [{"name": "#ff0000", "length_mm": 90}]})";
  fake.next_problem = unclear;
  const Asked asked = ask(fake, Method::Post, path, {}, R"({"way": "laser"})");
  CHECK(asked.response.status == 422);
  CHECK(asked.body["asks"]["looks"][0]["length_mm"] == 90);
}

TEST_CASE("a placed spec and a design's lattice come back as they were made",
          "[daemon][http][handlers]") {
  FakeService fake;
  const Asked placed =
      ask(fake, Method::Post, "/v1/place", {}, R"({"spec": {"popcut": 1}, "place": "whole"})");
  CHECK(placed.response.status == 200);
  CHECK(placed.body == json{{"spec", {{"popcut", 1}}}});
  CHECK(ask(fake, Method::Post, "/v1/place", {}, R"({"spec": {}})").response.status == 422);
  fake.design_map["sha256-1"].id = "sha256-1";
  const Asked lattice = ask(fake, Method::Get, "/v1/designs/sha256-1/lattice");
  CHECK(lattice.response.status == 200);
  CHECK(lattice.response.body == "PCLB");
  std::string etag, cache;
  for (const Header& header : lattice.response.headers) {
    if (header.name == "ETag") etag = header.value;
    if (header.name == "Cache-Control") cache = header.value;
  }
  CHECK(cache == "private, max-age=86400");
  const Asked seen =
      ask(fake, Method::Get, "/v1/designs/sha256-1/lattice", {{"if-none-match", "\"x\", " + etag}});
  CHECK(seen.response.status == 304);
  CHECK(seen.response.body.empty());
  CHECK(std::any_of(seen.response.headers.begin(), seen.response.headers.end(),
                    [&](const Header& header) { return header.value == cache; }));
  CHECK(ask(fake, Method::Get, "/v1/designs/sha256-2/lattice").response.status == 404);
}

TEST_CASE("a service that throws gives a problem and does not end the server",
          "[daemon][http][handlers]") {
  FakeService fake;
  fake.throws = true;
  const Asked thrown = ask(fake, Method::Get, "/v1/jobs");
  CHECK(thrown.response.status == 500);
  // What went wrong inside is for the log.
  CHECK(thrown.response.body.find("the fake was told to") == std::string::npos);
  fake.throws = false;
  fake.throws_bad_alloc = true;
  CHECK(ask(fake, Method::Get, "/v1/jobs").response.status == 503);
  fake.throws_bad_alloc = false;
  fake.healthy = false;
  CHECK(ask(fake, Method::Get, "/healthz").response.status == 503);
  CHECK(ask(fake, Method::Get, "/readyz").response.status == 503);
}

TEST_CASE("each kind of problem has its status and type", "[daemon][http][handlers]") {
  for (int kind = 0; kind <= static_cast<int>(ProblemKind::Internal); ++kind) {
    Problem problem{static_cast<ProblemKind>(kind), "why"};
    problem.retry_after_s = 3;
    const Response response = problem_response(problem, "/v1/jobs?secret=1", "01J");
    const json body = json::parse(response.body);
    CHECK(response.status == body.at("status"));
    CHECK(response.status >= 400);
    CHECK(reason_of(response.status) != "Unknown");
    CHECK(body.at("instance") == "/v1/jobs");
    CHECK(body.at("type").get<std::string>().size() > 26);
    CHECK(body.at("request_id") == "01J");
  }
}

TEST_CASE("text in the store that is not UTF-8 does not prevent an answer",
          "[daemon][http][handlers]") {
  FakeService fake;
  Job& job = fake.add_job(JobState::Queued, "a");
  job.name = "bad \xFF name";
  const Asked asked = ask(fake, Method::Get, "/v1/jobs/" + job.id);
  CHECK(asked.response.status == 200);
  CHECK(asked.body.at("name") == "bad \xEF\xBF\xBD name");
}

}  // namespace http_handlers_test
