// SPDX-License-Identifier: MIT
// openapi.json against the table of routes and against what the server does.
#include <algorithm>
#include <atomic>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include <fmt/format.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "core/plan/plan_options.hpp"
#include "daemon/http/api/openapi.hpp"
#include "daemon/http/api/page_files.hpp"
#include "daemon/http/api/routes.hpp"
#include "tests/support/json_schema.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/process.hpp"
#include "tests/support/raw_http.hpp"

namespace http_openapi_test {

using namespace popcut::daemon;
using nlohmann::json;
using popcut::JsonSchema;
using popcut::testing::source_file;
using popcut::testing::text_of_file;

namespace {

const json& document() {
  static const json value = json::parse(http::openapi_json());
  return value;
}

std::string lower(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  return out;
}

const json& operation(const http::Route& route) {
  return document().at("paths").at(std::string(route.path)).at(lower(http::name_of(route.method)));
}

const json& resolved(const json& value) { return JsonSchema(document()).resolved(value); }

bool has_parameter(const json& op, const std::string& in, const std::string& name) {
  const json parameters = op.value("parameters", json::array());
  return std::any_of(parameters.begin(), parameters.end(), [&](const json& parameter) {
    const json& one = resolved(parameter);
    return one.at("in") == in && one.at("name") == name;
  });
}

const json& operation_example(const std::string& schema) {
  return document().at("components").at("schemas").at(schema).at("example");
}

bool is_upload(const http::Route& route) {
  return route.body == http::BodyRule::Design || route.body == http::BodyRule::Asset;
}

// One request to a route that succeeds, put together from the route and its documentation.
struct Call {
  std::string target;
  std::string more;  ///< header lines
  std::string body;
};

struct Bench {
  explicit Bench(const std::function<void(HttpOptions&)>& change = {}) : server(change) {
    server.ask([&](FakeService& fake) {
      fake.job_map.clear();
      job = fake.add_job(JobState::Ready, "token:admin").id;
      const std::string hash(64, 'a');
      design = "sha256-" + hash;
      fake.design_map[design] = {design, "a", "spec", "token:admin", 1, 0, {}, true};
      PlanRecord made;
      made.id = plan = "01JD0000000000000000000900";
      made.design = design;
      made.state = PlanState::Planned;
      made.sheets.push_back({.number = 1,
                             .paths = 3,
                             .cut_mm = 2,
                             .fold_mm = 1,
                             .travel_mm = 1,
                             .seconds = 1,
                             .seconds_range = {1, 2},
                             .area_mm = {1, 1},
                             .program_sha256 = hash});
      fake.plan_map[plan] = made;
      asset = "sha256-" + std::string(64, 'b');
      fake.asset_map[asset] = {.id = asset, .name = "vase.obj", .bytes = 3, .designs = {design}};
      SearchRecord found;
      found.id = search = "01JD0000000000000000000901";
      found.owner = "token:admin";
      found.request = {
          .model = asset, .name = "vase", .material = "paper-220", .machine = "cameo3"};
      found.state = SearchState::Found;
      found.front.cards.push_back({.style = "facets",
                                   .settings = "facets of 2 mm",
                                   .warnings = {{.code = "note", .message = "thin"}},
                                   .spec = "{\"popcut\":1}"});
      fake.search_map[search] = found;
      const std::string path = (server.folder() / "file").string();
      std::FILE* const file = std::fopen(path.c_str(), "w");
      std::fputs("{}", file);
      std::fclose(file);
      fake.files[design] = path;
      fake.files[search + "/card-01.png"] = path;
      const std::string strokes = (server.folder() / "strokes").string();
      std::ofstream(strokes) << operation_example("Strokes").dump();
      for (const char* name :
           {"plan.json", "pattern.svg", "assembly.svg", "deploy.glb", "report.json", "sheet-01.svg",
            "sheet-01.gpgl", "sheet-01.strokes.json"})
        fake.files[plan + "/" + name] =
            std::string_view(name).ends_with(".strokes.json") ? strokes : path;
      fake.tell("job", job, R"("rev":1)");
    });
  }

  [[nodiscard]] std::string id_for(std::string_view path) const {
    if (path.starts_with("/v1/jobs")) return job;
    if (path.starts_with("/v1/designs")) return design;
    if (path.starts_with("/v1/plans")) return plan;
    if (path.starts_with("/v1/searches")) return search;
    if (path.starts_with("/v1/devices")) return "sim:cameo3";
    if (path.starts_with("/v1/materials")) return "paper-220";
    if (path.starts_with("/v1/assets")) return asset;
    return "viewer";  // a token or a session
  }

  [[nodiscard]] std::string etag_for(std::string_view path) {
    std::int64_t rev = 1;
    server.ask([&](FakeService& fake) {
      if (path.starts_with("/v1/jobs") || path.starts_with("/v1/queue"))
        rev = fake.job_map.at(job).rev;
      if (path.starts_with("/v1/devices")) rev = fake.device_map.at("sim:cameo3").rev;
    });
    return fmt::format("\"{}\"", rev);
  }

  Call call(const http::Route& route) {
    Call out;
    out.target = std::string(route.path);
    const auto put = [&](std::string_view hole, const std::string& value) {
      if (const std::size_t at = out.target.find(hole); at != std::string::npos)
        out.target.replace(at, hole.size(), value);
    };
    put("{id}", id_for(route.path));
    put("{k}", "1");
    put("{name}", "cut.svg");
    put("{file}", std::string(http::page_files().back().name));
    if (route.match != http::MatchRule::None)
      out.more += fmt::format("If-Match: {}\r\n", etag_for(route.path));
    static int keys = 0;
    if (route.key == http::KeyRule::Required)
      out.more += fmt::format("Idempotency-Key: contract-test-{:08}\r\n", ++keys);
    if (is_upload(route)) {
      out.more += "Content-Type: application/json\r\n";
      out.body = "{\"popcut\": 1}";
    } else if (route.body == http::BodyRule::Json) {
      out.more += "Content-Type: application/json\r\n";
      json example = schema_of(route).at("example");
      if (example.contains("job")) example["job"] = job;
      if (example.contains("one_shot"))
        server.ask(
            [&](FakeService& fake) { example["one_shot"] = *fake.access.create_one_shot({}); });
      if (example.contains("code") || example.contains("secret"))
        server.ask([&](FakeService& fake) {
          const NewPairing asked = *fake.access.ask_pairing("tablet", "127.0.0.1");
          if (example.contains("code")) example["code"] = asked.code;
          if (example.contains("secret")) example["secret"] = asked.secret;
        });
      out.body = example.dump();
    }
    if (route.is_stream) out.more += "Accept: application/json\r\n";
    return out;
  }

  [[nodiscard]] static const json& schema_of(const http::Route& route) {
    return resolved(
        operation(route).at("requestBody").at("content").at("application/json").at("schema"));
  }

  // Asks, and holds the answer against what is documented for its status.
  WireResponse ask(const http::Route& route, const Call& call, std::string_view role = "admin") {
    server.ask([&](FakeService& fake) {
      for (const Role one : {Role::Viewer, Role::Submitter, Role::Operator, Role::Admin}) {
        const std::string name(name_of(one));
        fake.bearers["pc_" + name + "_0123456789"] = {"token:" + name, one};
        fake.token_map[name] = {name, name, one, 0, std::nullopt};
        fake.session_map[name] = {name, "token:" + name, "", one, 0, 0, 0};
      }
      fake.material_map["paper-220"] = {"paper-220", 1, R"({"force_gf": 120})", true};
      fake.asset_map[asset] = {.id = asset, .name = "vase.obj", .bytes = 3, .designs = {design}};
    });
    return hold(route,
                server.fetch(http::name_of(route.method), call.target, role, call.more, call.body));
  }

  static WireResponse hold(const http::Route& route, WireResponse response) {
    const json& responses = operation(route).at("responses");
    const std::string status = std::to_string(response.status);
    INFO("status " << status << ": " << response.body.substr(0, 300));
    CHECK(responses.contains(status));
    if (!responses.contains(status)) return response;
    const json& documented = resolved(responses.at(status));
    const json headers = documented.value("headers", json::object());
    for (const auto& [name, header] : headers.items())
      if (name == "ETag" || name == "Location") CHECK(response.headers.count(lower(name)) == 1);
    if (!documented.contains("content")) {
      CHECK(response.body.empty());
      return response;
    }
    std::string type = response.headers["content-type"];
    type = type.substr(0, type.find(';'));
    CHECK(documented.at("content").contains(type));
    if (type.find("json") == std::string::npos || !documented.at("content").contains(type))
      return response;
    const json& content = documented.at("content").at(type);
    const json body = json::parse(response.body, nullptr, false);
    CHECK_FALSE(body.is_discarded());
    if (content.contains("schema"))
      for (const std::string& fault : JsonSchema(document()).faults(body, content.at("schema")))
        FAIL_CHECK(fault);
    return response;
  }

  LiveServer server;
  std::string job, design, plan, asset, search;
};

}  // namespace

TEST_CASE("openapi.json and the table of routes have the same routes", "[daemon][http][openapi]") {
  std::set<std::string> in_table, in_file;
  for (const http::Route& route : http::routes())
    in_table.insert(fmt::format("{} {}", lower(http::name_of(route.method)), route.path));
  for (const auto& [path, operations] : document().at("paths").items())
    for (const auto& [method, ignored] : operations.items()) in_file.insert(method + " " + path);
  CHECK(in_table == in_file);
}

TEST_CASE("openapi.json documents the role and headers and query of each route",
          "[daemon][http][openapi]") {
  std::set<std::string> ids;
  for (const http::Route& route : http::routes()) {
    CAPTURE(http::name_of(route.method), route.path);
    const json& op = operation(route);
    CHECK(op.at("x-popcut-role") ==
          (route.access.is_open() ? "everyone" : name_of(route.access.role())));
    CHECK(op.contains("security") == route.access.is_open());
    CHECK(ids.insert(op.at("operationId")).second);
    CHECK(has_parameter(op, "header", "If-Match") == (route.match != http::MatchRule::None));
    CHECK(has_parameter(op, "header", "Idempotency-Key") == (route.key != http::KeyRule::None));
    CHECK(op.contains("requestBody") == (route.body != http::BodyRule::None));
    std::string query;
    for (const json& parameter : op.value("parameters", json::array())) {
      const json& one = resolved(parameter);
      if (one.at("in") == "query")
        query += (query.empty() ? "" : " ") + one.at("name").get<std::string>();
      if (one.at("in") == "path")
        CHECK(route.path.find("{" + one.at("name").get<std::string>() + "}") !=
              std::string_view::npos);
    }
    CHECK(query == route.query);
  }
}

TEST_CASE("each documented request succeeds as it is documented", "[daemon][http][openapi]") {
  Bench bench;
  std::set<std::string> missing;
  for (const http::Route& route : http::routes()) {
    CAPTURE(http::name_of(route.method), route.path);
    // What this one removes, the next needs.
    const bool removes = route.method == http::Method::Delete;
    std::map<std::string, Job> jobs;
    std::map<std::string, Design> designs;
    std::map<std::string, PlanRecord> plans;
    std::map<std::string, SearchRecord> searches;
    bench.server.ask([&](FakeService& fake) {
      jobs = fake.job_map;
      designs = fake.design_map;
      plans = fake.plan_map;
      searches = fake.search_map;
    });
    const WireResponse response = bench.ask(route, bench.call(route));
    CHECK(response.status >= 200);
    CHECK(response.status < 300);
    bench.server.ask([&](FakeService& fake) {
      if (removes) fake.job_map = jobs;
      if (removes) fake.design_map = designs;
      if (removes) fake.plan_map = plans;
      if (removes) fake.search_map = searches;
      fake.job_map.at(bench.job).state = JobState::Ready;
    });
  }
}

TEST_CASE("each documented problem of each route is produced", "[daemon][http][openapi]") {
  std::atomic<bool> is_busy{false};
  Bench bench([&](HttpOptions& options) {
    options.limits.failed_logins_per_minute = 100'000;
    options.on_service = [&is_busy, take = options.on_service](std::function<void()> work) {
      return !is_busy && take(std::move(work));
    };
  });
  Bench strict([](HttpOptions& options) {
    options.limits.rate_per_s = 0.001;
    options.limits.rate_burst = 1;
    options.limits.previews_per_s = options.limits.pictures_per_s = 0.001;
    options.limits.failed_logins_per_minute = 100'000;
  });
  const std::map<int, ProblemKind> told{{404, ProblemKind::NotFound},
                                        {409, ProblemKind::StateConflict},
                                        {412, ProblemKind::Stale},
                                        {507, ProblemKind::DiskFull}};
  for (const http::Route& route : http::routes()) {
    const std::string_view method = http::name_of(route.method);
    for (const auto& [status, ignored] : operation(route).at("responses").items()) {
      const int code = std::stoi(status);
      if (code < 400) continue;
      CAPTURE(method, route.path, code);
      Call call = bench.call(route);
      std::string_view role = "admin";
      const auto replace = [](std::string& text, const std::string& from, const std::string& to) {
        if (const std::size_t at = text.find(from); at != std::string::npos)
          text.replace(at, from.size(), to);
      };
      if (const auto kind = told.find(code); kind != told.end())
        bench.server.ask([&](FakeService& fake) {
          fake.next_problem = Problem{kind->second, "told"};
        });
      switch (code) {
        case 400:
          call.target += "%zz";
          break;
        case 401:
          if (route.access.is_open())
            bench.server.ask([](FakeService& fake) {
              fake.next_problem = Problem{ProblemKind::Unauthenticated, "told"};
            });
          else
            role = "";
          break;
        case 403:
          if (!route.access.is_open() && route.access.role() > Role::Viewer)
            role = "viewer";
          else if (route.method != http::Method::Get)
            call.more += "Origin: http://evil.example\r\n";
          break;
        case 404:
          if (route.is_static) call.target += "x";
          break;
        case 413:
          if (route.body == http::BodyRule::None)
            call.more += "X-Filler: " + std::string(9000, 'x') + "\r\n";
          else
            call.more += "Content-Length: 999999999999\r\n";
          call.body.clear();
          break;
        case 415:
          replace(call.more, "Content-Type: application/json", "Content-Type: text/plain");
          if (call.body.empty() || call.body == "{}") call.body = "{ }";
          break;
        case 422:
          call.target += "?no-such-name=1";
          break;
        case 428:
          replace(call.more, "If-Match", "X-If-Match");
          break;
        case 500:
          bench.server.ask([](FakeService& fake) { fake.throws = true; });
          break;
        case 503:
          is_busy = true;
          break;
        default:
          break;
      }
      WireResponse response;
      if (code == 421) {
        RawConnection connection = bench.server.connect();
        connection.send(fmt::format("{} {} HTTP/1.1\r\nHost: evil\r\n\r\n", method, call.target));
        response = Bench::hold(route, connection.receive());
      } else if (code == 403 && route.method == http::Method::Get && role == "admin") {
        // Over TCP each token may read; a user of the socket may have no role.
        auto nobody = RawConnection::as_user(65534, bench.server.socket_path());
        if (!nobody) continue;
        nobody->send(fmt::format("GET {} HTTP/1.1\r\nHost: popcut\r\n\r\n", call.target));
        response = Bench::hold(route, nobody->receive());
      } else if (code == 429) {
        Call again = strict.call(route);
        // Only those that are wrong count.
        if (route.guess == http::Guess::Secret) again.body = R"({"secret":"wrong"})";
        for (int i = 0; i < 3 && response.status != 429; ++i) response = strict.ask(route, again);
      } else {
        response = bench.ask(route, call, role);
      }
      CHECK(response.status == code);
      is_busy = false;
      bench.server.ask([](FakeService& fake) {
        fake.throws = false;
        fake.next_problem.reset();
      });
      if (code == 429)
        strict.server.ask([&](FakeService& fake) { fake.job_map.at(strict.job).rev = 1; });
    }
  }
}

TEST_CASE("each member of each documented body is read and no other", "[daemon][http][openapi]") {
  Bench bench;
  for (const http::Route& route : http::routes()) {
    if (route.body != http::BodyRule::Json || route.path == "/v1/materials/{id}") continue;
    const json& schema = Bench::schema_of(route);
    CAPTURE(route.path);
    const auto refused = [&](json body) {
      Call call = bench.call(route);
      call.body = body.dump();
      const WireResponse response = bench.ask(route, call);
      CHECK(response.status == 422);
      return response.body;
    };
    json example = schema.at("example");
    for (const auto& [name, property] : schema.at("properties").items()) {
      CAPTURE(name);
      json wrong = example;
      wrong[name] = json::array({json::array()});
      CHECK(refused(wrong).find(fmt::format("\"pointer\":\"/{}\"", name)) != std::string::npos);
      // One letter too many, and the right name is proposed.
      json misspelt = example;
      misspelt[name + "x"] = 1;
      const std::string answer = refused(misspelt);
      CHECK(answer.find("unknown_member") != std::string::npos);
      CHECK(answer.find(fmt::format("did you mean /{}?", name)) != std::string::npos);
    }
    for (const json& name : schema.value("required", json::array())) {
      json without = example;
      without.erase(name.get<std::string>());
      CHECK(refused(without).find(fmt::format("\"pointer\":\"/{}\",\"code\":\"missing\"",
                                              name.get<std::string>())) != std::string::npos);
    }
    CHECK(refused(json::array()).find("must be an object") != std::string::npos);
  }
}

TEST_CASE("the served description is the one in the repository", "[daemon][http][openapi]") {
  LiveServer server;
  const WireResponse served = server.fetch("GET", "/v1/openapi.json", "viewer");
  CHECK(served.body == http::openapi_json());
  const json meta = json::parse(server.fetch("GET", "/v1/meta", "viewer").body);
  CHECK(served.headers.at("etag") == "\"" + meta.at("schema_sha256").get<std::string>() + "\"");
}

TEST_CASE("the kinds of attention are those that docs/api.md explains", "[daemon][http][openapi]") {
  const std::string page = text_of_file(source_file("docs/api.md"));
  const std::size_t begin = page.find("`attention` says what a person must do");
  REQUIRE(begin != std::string::npos);
  std::set<std::string> explained;
  std::istringstream lines(page.substr(begin, page.find("\n## ", begin) - begin));
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with("| `") && !line.starts_with("| `kind`"))
      explained.insert(line.substr(3, line.find('`', 3) - 3));
  const json& kinds =
      document().at("/components/schemas/Attention/properties/kind/enum"_json_pointer);
  CHECK(explained == kinds.get<std::set<std::string>>());
}

TEST_CASE("the description has each option of a plan with its type and its limits",
          "[daemon][http][openapi]") {
  const json& properties =
      document().at("components").at("schemas").at("PlanOptions").at("properties");
  for (const popcut::PlanOption& option : popcut::plan_option_table()) {
    CAPTURE(option.name);
    REQUIRE(properties.contains(std::string(option.name)) == !option.of_request);
    if (option.of_request) continue;
    const json& schema = properties.at(std::string(option.name));
    CHECK(schema.at("description").get<std::string>().rfind(option.help, 0) == 0);
    if (!option.words.empty()) CHECK(schema.at("enum") == json(option.words));
    if (option.kind == popcut::PlanOption::Kind::Number) CHECK(schema.at("maximum") == option.most);
  }
  CHECK(properties.at("snap").at("default") == 0.05);
  CHECK_FALSE(properties.at("overcut").contains("default"));
}

}  // namespace http_openapi_test
