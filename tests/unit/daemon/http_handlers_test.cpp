// SPDX-License-Identifier: MIT
// Handlers without sockets.
#include <algorithm>
#include <future>

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
#include "tests/support/raw_http.hpp"

namespace http_handlers_test {

using namespace popcut::daemon;
using namespace popcut::daemon::http;
using nlohmann::json;

namespace {

struct Asked {
  Response response;
  json body;
};

Asked ask(ServiceForHttp& http, Method method, const std::string& target,
          std::vector<Header> headers = {}, const std::string& body = "",
          Principal principal = {"token:admin", Role::Admin}, Cutting* cutting = nullptr) {
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
  const Service& own = http.service();
  Service service{own.access,   own.designs,   own.plans,
                  own.searches, own.jobs,      cutting != nullptr ? *cutting : own.cutting,
                  own.devices,  own.materials, own.operations};
  std::promise<Response> answer;
  const Reply reply([&](Response response) { answer.set_value(std::move(response)); });
  const HandlerContext context;
  http.ask([&](LiveService&) { dispatch(request, *match.route, service, context, reply); });
  Asked out;
  out.response = answer.get_future().get();
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

/// Takes every action, and does nothing.
struct Patient final : Cutting {
  explicit Patient(Jobs& all) : jobs(all) {}
  Answer<Job> act(const Principal&, const std::string& id, std::int64_t,
                  const ActionRequest& request) override {
    last = request;
    return jobs.find(id);
  }
  Jobs& jobs;
  ActionRequest last{};
};

std::string etag_of(ServiceForHttp& http, const std::string& job) {
  return fmt::format("\"{}\"", http.bench.job(job).rev);
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
  ServiceForHttp http;
  const Asked examples = ask(http, Method::Get, "/v1/examples");
  REQUIRE(examples.response.status == 200);
  CHECK(examples.body.at("items").size() == popcut::examples().size());
  CHECK(examples.body.at("next_cursor").is_null());
  for (const json& item : examples.body.at("items")) {
    CAPTURE(item.at("name"));
    CHECK_FALSE(item.at("title").get<std::string>().empty());
    CHECK(popcut::parse_design_spec(item.at("spec").dump()));
  }
  const Asked schema = ask(http, Method::Get, "/v1/design-schema");
  CHECK(schema.response.body == popcut::design_spec_schema());
  for (const Asked* fixed : {&examples, &schema}) {
    const std::string etag = fixed->response.headers.at(0).value;
    CHECK(ask(http, Method::Get, fixed == &examples ? "/v1/examples" : "/v1/design-schema",
              {{"if-none-match", etag}})
              .response.status == 304);
  }
  const Asked machines = ask(http, Method::Get, "/v1/machines");
  CHECK(machines.body.at("items").size() == popcut::all_machines()->size());
  CHECK(machines.body.at("items").at(0).at("mats").is_array());
}

TEST_CASE("the strokes of a sheet are a file of its plan", "[daemon][http][handlers]") {
  ServiceForHttp http;
  const std::string plan = http.bench.ready_job().plan;
  const std::string path = http.bench.folder() + "/plans/" + plan + "/sheet-01.strokes.json";
  popcut::testing::write_text(path, "{}");
  const auto strokes = [&](const std::string& sheet, std::vector<Header> headers = {}) {
    return ask(http, Method::Get, "/v1/plans/" + plan + "/sheets/" + sheet + "/strokes",
               std::move(headers))
        .response;
  };
  const Response first = strokes("1");
  CHECK(first.status == 200);
  CHECK(first.file == path);
  const std::string etag = "\"" + plan + "-1-strokes\"";
  CHECK(first.headers.at(0).value == etag);
  CHECK(strokes("1", {{"if-none-match", etag}}).status == 304);
  CHECK(strokes("1", {{"if-none-match", etag}}).file.empty());
  for (const char* sheet : {"2", "0", "-1", "01", "x", "99999999999999999999"})
    CHECK(strokes(sheet).status == 404);
}

TEST_CASE("meta names who asks and whether a session does", "[daemon][http][handlers]") {
  ServiceForHttp http;
  const auto meta = [&](const Principal& who) {
    return ask(http, Method::Get, "/v1/meta", {}, "", who).body;
  };
  Principal viewer = http.principal(Role::Viewer);
  const json token = meta(viewer);
  CHECK(token.at("principal").at("title") == "viewer");
  CHECK(token.at("session") == false);
  http.ask([&](LiveService& service) {
    const std::string word = service.access.create_one_shot(viewer).value();
    viewer.credential = service.access.open_session(word).value().record.id;
  });
  CHECK(meta(viewer).at("session") == true);
  const auto now = time_from(token.at("now").get<std::string>());
  REQUIRE(now);
  CHECK(std::abs(*now - popcut::daemon::wall_clock_ms()) < 60'000);
}

TEST_CASE("every member of a job request reaches the service", "[daemon][http][handlers]") {
  ServiceForHttp http;
  const auto create = [&](const json& body) {
    const Asked asked = ask(http, Method::Post, "/v1/jobs", keyed(), body.dump(), kSubmitter);
    CAPTURE(asked.response.body);
    REQUIRE(asked.response.status == 201);
    return asked.body;
  };
  const std::string design = http.design();
  const json made = create({{"design", design},
                            {"material", "paper-160"},
                            {"device", "sim:cameo3"},
                            {"copies", 3},
                            {"priority", -2},
                            {"name", "Karte \u00e4"},
                            {"note", "a\nb"},
                            {"tags", {"x", "y"}},
                            {"on_sheet_done", "wait"},
                            {"options", {{"order", "best"}, {"effort", 2}}}});
  CHECK(made.at("owner") == "token:submitter");
  CHECK(made.at("started").is_null());
  const Job job = http.bench.wait_for(made.at("id"), JobState::Ready);
  CHECK(job.design == design);
  CHECK(job.material == "paper-160");
  CHECK(job.device == "sim:cameo3");
  CHECK(job.copies == 3);
  CHECK(job.sheet == 1);
  CHECK(job.priority == -2);
  CHECK(job.name == "Karte \u00e4");
  CHECK(job.note == "a\nb");
  CHECK(job.tags == std::vector<std::string>{"x", "y"});
  CHECK(http.bench.planner.last_task().options.at("effort") == "2");
  const Job of_plan = http.bench.job(create({{"plan", job.plan}}).at("id"));
  CHECK(of_plan.plan == job.plan);
  CHECK(http.bench.job(create({{"design", design}, {"site", "hall"}}).at("id")).site == "hall");
}

TEST_CASE("the members of each action reach the service", "[daemon][http][handlers]") {
  ServiceForHttp http;
  const std::string id = http.bench.ready_job().id;
  Patient patient(http.service().jobs);
  const auto act = [&](const std::string& action, const std::string& body) {
    const Asked asked = ask(http, Method::Post, "/v1/jobs/" + id + "/actions/" + action,
                            keyed(etag_of(http, id)), body, kOperator, &patient);
    CAPTURE(action, asked.response.body);
    CHECK(asked.response.status == 200);
    return patient.last;
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
  ServiceForHttp http;
  const std::string id = http.bench.ready_job().id;
  http.bench.act(id, JobAction::Arm).value();
  const std::string start = "/v1/jobs/" + id + "/actions/start";
  CHECK(ask(http, Method::Post, start, keyed(), "{}").response.status == 428);
  for (const char* bad : {"*", "1", "W/\"1\"", "\"\"", "\"x\"", "\"1\", \"2\"", "\"-1\"", "\"1"}) {
    CAPTURE(bad);
    CHECK(ask(http, Method::Post, start, keyed(bad), "{}").response.status == 400);
  }
  const Asked stale = ask(http, Method::Post, start, keyed("\"77\""), "{}");
  CHECK(stale.response.status == 412);
  CHECK(stale.body.at("rev") == http.bench.job(id).rev);
  CHECK(stale.body.at("state") == "armed");
  CHECK(ask(http, Method::Post, start, keyed(etag_of(http, id)), "{}").response.status == 200);
}

TEST_CASE("submitters may change only their own jobs", "[daemon][http][handlers]") {
  ServiceForHttp http;
  const std::string other = http.bench.ready_job().id;
  const std::string own = ask(http, Method::Post, "/v1/jobs", keyed(),
                              R"({"design":")" + http.design() + "\"}", kSubmitter)
                              .body.at("id");
  for (const auto& [id, status] : {std::pair{own, 200}, std::pair{other, 403}}) {
    CHECK(ask(http, Method::Patch, "/v1/jobs/" + id, {{"if-match", etag_of(http, id)}},
              R"({"priority":1})", kSubmitter)
              .response.status == status);
    CHECK(
        ask(http, Method::Post, "/v1/jobs/" + id + "/actions/cancel", keyed("*"), "{}", kSubmitter)
            .response.status == status);
  }
  CHECK(ask(http, Method::Delete, "/v1/jobs/" + other, {}, "", kSubmitter).response.status == 403);
  CHECK(ask(http, Method::Delete, "/v1/jobs/" + own, {}, "", kSubmitter).response.status == 204);
  http.bench.act(other, JobAction::Cancel).value();
  CHECK(ask(http, Method::Delete, "/v1/jobs/" + other, {}, "", kOperator).response.status == 204);
}

TEST_CASE("pages continue where they ended and invented cursors are refused",
          "[daemon][http][handlers]") {
  ServiceForHttp http;
  const std::string design = http.design();
  for (int i = 0; i < 25; ++i) REQUIRE(http.bench.create(design));
  std::string cursor;
  std::vector<std::string> ids;
  int pages = 0;
  do {
    const Asked page =
        ask(http, Method::Get, "/v1/jobs?limit=10" + (cursor.empty() ? "" : "&cursor=" + cursor));
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
    const Asked page = ask(http, Method::Get, fmt::format("/v1/jobs?{}", bad));
    CHECK(page.response.status == 422);
    CHECK(page.body.at("errors").size() == 1);
  }
}

TEST_CASE("a fault quotes the wrong value but never a secret", "[daemon][http][handlers]") {
  ServiceForHttp http;
  const auto got = [&](const std::string& target, const std::string& body) {
    return ask(http, Method::Post, target, keyed(), body).body.at("errors").at(0);
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
  ServiceForHttp http;
  const std::string design = http.design();
  for (int i = 0; i < 3; ++i) REQUIRE(http.bench.create(design));
  const std::string cursor =
      ask(http, Method::Get, "/v1/jobs?limit=1").body.at("next_cursor").get<std::string>();
  for (const char* list :
       {"/v1/queue", "/v1/designs", "/v1/devices", "/v1/materials", "/v1/tokens"}) {
    CAPTURE(list);
    const Asked asked = ask(http, Method::Get, fmt::format("{}?cursor={}", list, cursor));
    CHECK(asked.response.status == 422);
    CHECK(asked.body.at("errors").at(0).at("pointer") == "?cursor");
    CHECK(ask(http, Method::Get, fmt::format("{}?limit=200", list)).response.status == 200);
  }
}

TEST_CASE("a hold checks the revision that was sent", "[daemon][http][handlers]") {
  ServiceForHttp http;
  const std::string id = http.bench.ready_job().id;
  const std::string body = R"({"job":")" + id + "\"}";
  const Asked stale = ask(http, Method::Post, "/v1/queue/actions/hold", keyed("\"99\""), body);
  CHECK(stale.response.status == 412);
  CHECK(stale.body.at("rev") == http.bench.job(id).rev);
  CHECK(ask(http, Method::Post, "/v1/queue/actions/hold", keyed(etag_of(http, id)), body)
            .response.status == 200);
}

TEST_CASE("a test cut names its material and its job", "[daemon][http][handlers]") {
  ServiceForHttp http;
  const auto rev = [&] {
    return fmt::format("\"{}\"",
                       ask(http, Method::Get, "/v1/devices/sim:cameo3").body.at("rev").dump());
  };
  const Asked made = ask(http, Method::Post, "/v1/devices/sim:cameo3/actions/test-cut",
                         keyed(rev()), R"({"material":"paper-160"})");
  REQUIRE(made.response.status == 200);
  CHECK(http.bench.job(made.body.at("test_job")).material == "paper-160");
  CHECK(ask(http, Method::Post, "/v1/devices/sim:cameo3/actions/reset", keyed(rev()),
            R"({"material":"pp-150"})")
            .response.status == 422);
}

TEST_CASE("lists are filtered by state and owner and time", "[daemon][http][handlers]") {
  ServiceForHttp http;
  const std::string ready = http.bench.ready_job().id, armed = http.bench.ready_job().id,
                    others = http.bench.ready_job().id;
  http.bench.act(armed, JobAction::Arm).value();
  http.bench.act(http.bench.ready_job().id, JobAction::Cancel).value();
  http.ask([&](LiveService&) {
    Database& db = http.bench.store().database();
    db.run("UPDATE job SET device=?", http.bench.device);
    db.run("UPDATE job SET owner='uid:1000' WHERE id<>?", others);
  });
  const auto list = [&](const std::string& query) {
    const Asked asked = ask(http, Method::Get, "/v1/jobs?" + query);
    CHECK(asked.response.status == 200);
    std::vector<std::string> ids;
    for (const json& job : asked.body.at("items")) ids.push_back(job.at("id"));
    return ids;
  };
  const std::string filter =
      "state=ready,armed&owner=uid%3A1000&device=sim:cameo3&since=2026-11-21T10:00:00.5Z";
  using Ids = std::vector<std::string>;
  CHECK(list(filter) == Ids{ready, armed});
  CHECK(list(filter + "&order=asc") == Ids{ready, armed});
  CHECK(list(filter + "&order=desc") == Ids{armed, ready});
  CHECK(list("device=sim:cameo4").empty());
  CHECK(list("since=2999-01-01T00:00:00.5Z").empty());
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
  ServiceForHttp http;
  const std::string at = "/v1/materials/card-777",
                    row = R"({"like": "paper-220", "thickness_mm": 0.3})";
  CHECK(ask(http, Method::Put, at, {}, row).response.status == 428);
  CHECK(ask(http, Method::Put, at, {{"if-match", "\"1\""}, {"if-none-match", "*"}}, row)
            .response.status == 428);
  const Asked made = ask(http, Method::Put, at, {{"if-none-match", "*"}}, row);
  CHECK(made.response.status == 201);
  CHECK(made.body.at("material").at("thickness_mm") == 0.3);
  CHECK(ask(http, Method::Put, at, {{"if-none-match", "*"}}, row).response.status == 412);
  CHECK(ask(http, Method::Put, at, {{"if-match", "\"1\""}}, row).response.status == 200);
  CHECK(ask(http, Method::Put, "/v1/materials/A%20b", {{"if-none-match", "*"}}, row)
            .response.status == 422);
  CHECK(ask(http, Method::Put, at, {{"if-match", "\"2\""}}, "[]").response.status == 422);
}

TEST_CASE("usage as CSV contains no spreadsheet formulas", "[daemon][http][handlers]") {
  ServiceForHttp http;
  http.ask([&](LiveService&) {
    Database& db = http.bench.store().database();
    const auto used = [&](const char* owner, double seconds, double cut_mm, int sheets) {
      db.insert("usage(time, owner, operator, device, material, job, k, seconds, cut_mm, sheets)",
                *time_from("2026-01-02"), owner, "", "", "", "", 1, seconds, cut_mm, sheets);
    };
    used("uid:0", 12.5, 340.25, 2);
    used("=cmd|' /C calc'!A0", 1, 2, 3);
  });
  const Asked csv =
      ask(http, Method::Get, "/v1/usage?by=owner&from=2026-01-01", {{"accept", "text/csv"}});
  CHECK(csv.response.content_type == "text/csv; charset=utf-8");
  CHECK(csv.response.body ==
        "owner,seconds,cut_mm,sheets\r\n\"'=cmd|' /C calc'!A0\",1.000,2.000,3\r\n"
        "\"uid:0\",12.500,340.250,2\r\n");
  CHECK(ask(http, Method::Get, "/v1/usage").body.at("items").size() == 2);
  CHECK(ask(http, Method::Get, "/v1/usage?by=shoe").response.status == 422);
}

TEST_CASE("sheets and ledgers are reported as ranges of strokes", "[daemon][http][handlers]") {
  ServiceForHttp http;
  const std::string at = "/v1/jobs/" + popcut::testing::broken(http.bench).id + "/sheets";
  CHECK(ask(http, Method::Get, at).body.at("items").size() == 2);
  CHECK(ask(http, Method::Get, at + "/2").body.at("sheet") == 2);
  for (const char* bad : {"/3", "/0", "/-1", "/01", "/x", "/9999999"})
    CHECK(ask(http, Method::Get, at + bad).response.status == 404);
  const json ledger = ask(http, Method::Get, at + "/1/ledger").body;
  CHECK(ledger.at("in_doubt") == json::parse("[[2,2]]"));
  CHECK(ledger.at("certain_upto") == 1);
}

TEST_CASE("the program of a sheet is found in either language", "[daemon][http][handlers]") {
  ServiceForHttp http;
  const std::string plan = http.bench.ready_job().plan;
  const std::string folder = http.bench.folder() + "/plans/" + plan;
  popcut::testing::write_text(folder + "/sheet-12.hpgl", "IN;");
  const auto program = [&](const std::string& sheet) {
    return ask(http, Method::Get, "/v1/plans/" + plan + "/sheets/" + sheet + "/program").response;
  };
  CHECK(program("1").file == folder + "/sheet-01.gpgl");
  CHECK(program("12").file == folder + "/sheet-12.hpgl");
  CHECK(program("3").status == 404);
}

TEST_CASE("a preview reaches the service with its spec, quality and key",
          "[daemon][http][handlers]") {
  ServiceForHttp http;
  http.previewer->blob = "PCLB";
  const std::vector<Header> key{{"preview-key", "page-0123456789abc"}};
  const Asked drawn = ask(http, Method::Post, "/v1/preview", key,
                          R"({"spec": {"popcut": 1, "slices": 3}, "quality": "draft"})");
  CHECK(drawn.response.status == 200);
  CHECK(drawn.response.content_type == "application/vnd.popcut.lattice");
  CHECK(drawn.response.body == "PCLB");
  PreviewTask asked = http.previewer->last_task();
  CHECK(json::parse(asked.task.design_text) == json{{"popcut", 1}, {"slices", 3}});
  CHECK(asked.task.options.at("quality") == "draft");
  CHECK(asked.key == "page-0123456789abc");
  CHECK_FALSE(asked.task.options.contains("place"));
  CHECK(ask(http, Method::Post, "/v1/preview", {},
            R"({"spec": {}, "quality": "exact", "place": "quarter"})")
            .response.status == 200);
  asked = http.previewer->last_task();
  CHECK(asked.task.options.at("quality") == "exact");
  CHECK(asked.task.options.at("place") == "quarter");
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
    const Asked refused = ask(http, Method::Post, "/v1/preview", key, one.body);
    CHECK(refused.response.status == 422);
    CHECK(refused.body["errors"][0]["pointer"] == one.pointer);
  }
  for (const char* bad : {"short", "has a blank in it 123456"})
    CHECK(ask(http, Method::Post, "/v1/preview", {{"preview-key", bad}},
              R"({"spec": {}, "quality": "draft"})")
              .response.status == 400);
  http.previewer->fail_next({ProblemKind::Superseded, "a newer one came"});
  const Asked older =
      ask(http, Method::Post, "/v1/preview", key, R"({"spec": {}, "quality": "draft"})");
  CHECK(older.response.status == 409);
  CHECK(older.body["type"] == "https://popcut.invalid/p/superseded");
}

TEST_CASE("the sheets of a design come as they were made, and a question as data",
          "[daemon][http][handlers]") {
  ServiceForHttp http;
  CHECK(ask(http, Method::Post, "/v1/designs/sha256-1/make", {}, R"({"way": "hand"})")
            .response.status == 404);
  const std::string path = "/v1/designs/" + http.design() + "/make";
  http.previewer->blob = R"({"way": "as it was made"})";
  const Asked made =
      ask(http, Method::Post, path, {}, R"({"way": "hand", "options": {"mat": "A4"}})");
  CHECK(made.response.status == 200);
  CHECK(made.body == json{{"way", "as it was made"}});
  CHECK(http.previewer->last_task().task.options.at("make-way") == "hand");
  for (const char* wrong : {"{}", R"({"way": "glue"})", R"({"way": "hand", "mat": "A4"})"})
    CHECK(ask(http, Method::Post, path, {}, wrong).response.status == 422);
  http.previewer->blob =
      R"({"asks":{"asks": "colors", "looks": [{"name": "#ff0000", "length_mm": 90}]}})";
  const Asked asked = ask(http, Method::Post, path, {}, R"({"way": "laser"})");
  CHECK(asked.response.status == 422);
  CHECK(asked.body["asks"]["looks"][0]["length_mm"] == 90);
}

TEST_CASE("a placed spec and a design's lattice come back as they were made",
          "[daemon][http][handlers]") {
  ServiceForHttp http;
  http.previewer->blob = R"({"popcut": 1})";
  const Asked placed =
      ask(http, Method::Post, "/v1/place", {}, R"({"spec": {"popcut": 1}, "place": "whole"})");
  CHECK(placed.response.status == 200);
  CHECK(placed.body == json{{"spec", {{"popcut", 1}}}});
  CHECK(ask(http, Method::Post, "/v1/place", {}, R"({"spec": {}})").response.status == 422);
  http.previewer->blob = "PCLB";
  const std::string path = "/v1/designs/" + http.design() + "/lattice";
  const Asked lattice = ask(http, Method::Get, path);
  CHECK(lattice.response.status == 200);
  CHECK(lattice.response.body == "PCLB");
  std::string etag, cache;
  for (const Header& header : lattice.response.headers) {
    if (header.name == "ETag") etag = header.value;
    if (header.name == "Cache-Control") cache = header.value;
  }
  CHECK(cache == "private, max-age=86400");
  const Asked seen = ask(http, Method::Get, path, {{"if-none-match", "\"x\", " + etag}});
  CHECK(seen.response.status == 304);
  CHECK(seen.response.body.empty());
  CHECK(std::any_of(seen.response.headers.begin(), seen.response.headers.end(),
                    [&](const Header& header) { return header.value == cache; }));
  CHECK(ask(http, Method::Get, "/v1/designs/sha256-2/lattice").response.status == 404);
}

TEST_CASE("a service that throws gives a problem and does not end the server",
          "[daemon][http][handlers]") {
  ServiceForHttp http;
  http.devices().fault = [] { throw std::runtime_error("a secret of the inside"); };
  const Asked thrown = ask(http, Method::Get, "/v1/devices");
  CHECK(thrown.response.status == 500);
  // What went wrong inside is for the log.
  CHECK(thrown.response.body.find("a secret of the inside") == std::string::npos);
  http.devices().fault = [] { throw std::bad_alloc(); };
  CHECK(ask(http, Method::Get, "/v1/devices").response.status == 503);
  http.devices().fault = {};
  http.ask([](LiveService& service) { service.check_ended("is damaged: a page"); });
  CHECK(ask(http, Method::Get, "/healthz").response.status == 503);
  CHECK(ask(http, Method::Get, "/readyz").response.status == 503);
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
  ServiceForHttp http;
  const std::string id = http.bench.ready_job().id;
  http.put_texts(id, "bad \xFF name", "");
  const Asked asked = ask(http, Method::Get, "/v1/jobs/" + id);
  CHECK(asked.response.status == 200);
  CHECK(asked.body.at("name") == "bad \xEF\xBF\xBD name");
}

}  // namespace http_handlers_test
