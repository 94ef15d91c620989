// SPDX-License-Identifier: MIT
// How long each kind of request keeps the service's thread, with as much stored as there may be and
// with the largest input that is accepted. That thread feeds the knife and stops it, so no turn of
// it may be long. The routes are those of the table: a new one is measured without being named
// here.
#include <atomic>
#include <cstdio>
#include <map>
#include <set>

#include <fmt/format.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "daemon/http/api/dispatch.hpp"
#include "daemon/http/api/target.hpp"
#include "daemon/planning/program_file.hpp"
#include "tests/support/fake_previewer.hpp"
#include "tests/support/service_bench.hpp"
#include "tests/support/timing.hpp"

namespace service_turns_test {

using namespace popcut;
using namespace popcut::daemon;
using namespace popcut::daemon::http;
using popcut::testing::ServiceBench;
using Lane = ServiceThread::Lane;

namespace {

// Processor time; even that swings with what else runs on the machine. This build is not the
// optimised one, whose turns are shorter.
double longest_turn_s() { return popcut::testing::judges_time() ? 0.05 : 1.0; }

constexpr int kStrokes = 50'000;
constexpr int kSheets = 10'000;    // of a plan that is stored
constexpr int kNewSheets = 2'000;  // of one that is made, which writes as many files

/// Ids as popcutd makes them, that sort after those of today.
std::string id_sql(const char* letter) { return fmt::format("printf('7{}%024d', n)", letter); }

/// The columns of a table but for those that are given anew.
std::string others_of(Database& db, const std::string& table, const std::set<std::string>& given) {
  std::string all;
  Rows rows = db.rows("SELECT name FROM pragma_table_info(?)", table);
  while (rows.next())
    if (!given.contains(rows.text(0))) all += (all.empty() ? "" : ", ") + rows.text(0);
  return all;
}

/// A service with a history: what is stored is near what may be, or more than a workshop ever has.
class World : public ServiceBench {
 public:
  World() : ServiceBench(false) {
    options.previewer = std::make_shared<testing::FakePreviewer>();
    options.read_program = [this](const std::string& folder, int sheet) -> Result<StoredProgram> {
      auto fake = testing::read_fake_program(folder, sheet);
      if (!fake) return fake;
      const std::string& index = index_of(fake->program);
      auto program = planning::read_program(index, std::move(fake->program.bytes));
      if (!program) return tl::unexpected(program.error());
      return StoredProgram{std::move(*program), fake->index_sha256};
    };
    planner.strokes = kStrokes;
    planner.sheets = 1;
    REQUIRE(start() == "");
    design = add_design("{\"big\":1}").value().id;
    job = create(design).value().id;
    plan = wait_for(job, JobState::Ready).plan;
    planner.strokes = 5;
    stop();
    fill();
    REQUIRE(start() == "");
  }
  ~World() { stop(); }  // it may still read a program through us

  std::string design, job, plan;    ///< one sheet of many strokes
  std::string long_job, long_plan;  ///< many sheets
  std::string ended_job, used_token;

 private:
  // What the planner would have written beside the program, once.
  const std::string& index_of(const EncodedProgram& program) {
    std::string& index = indices_[sha256_hex(program.bytes)];
    if (index.empty()) index = planning::program_index(program);
    return index;
  }

  void fill() {
    auto store = Store::open({.folder = folder(), .reserve_bytes = reserve_bytes}).value();
    Database& db = store->database();
    const auto many = [](int count) {
      return fmt::format("WITH RECURSIVE c(n) AS (SELECT 1 UNION ALL SELECT n+1 FROM c WHERE n<{})",
                         count);
    };
    const auto copies = [&](const std::string& table, int count, const std::string& where,
                            const std::map<std::string, std::string>& fresh) {
      std::set<std::string> given;
      std::string names, values;
      for (const auto& [name, value] : fresh) {
        given.insert(name);
        names += name + ", ";
        values += value + ", ";
      }
      const std::string rest = others_of(db, table, given);
      db.script(fmt::format("{0} INSERT INTO {1}({2} {4}) SELECT {3} {4} FROM c, {1} WHERE {5};",
                            many(count), table, names, values, rest, where));
    };
    long_plan = fmt::format("7P{:024}", 1), long_job = fmt::format("7K{:024}", 1);
    ended_job = fmt::format("7E{:024}", 1), used_token = fmt::format("7T{:024}", 1);
    db.script("PRAGMA synchronous=OFF; BEGIN;");
    const std::string this_plan = "id='" + plan + "'", this_job = "id='" + job + "'";
    copies("plan", 300, this_plan, {{"id", id_sql("P")}, {"key", "'key-' || n"}});
    copies("plan_sheet", kSheets, "plan='" + plan + "'",
           {{"plan", "'" + long_plan + "'"}, {"sheet", "n"}});
    db.script(fmt::format("UPDATE plan SET sheets={} WHERE id='{}';", kSheets, long_plan));
    copies("job", 1, this_job,
           {{"id", id_sql("K")},
            {"plan", "'" + long_plan + "'"},
            {"sheets_total", std::to_string(kSheets)}});
    // Positions without room between two of them.
    copies("job", 10'000, this_job,
           {{"id", id_sql("J")}, {"requested_device", "'sim:other'"}, {"position", "5000000 + n"}});
    copies("job", 10'000, this_job,
           {{"id", id_sql("E")},
            {"state", "'cancelled'"},
            {"finished", "created"},
            {"deleted", "n % 2 = 0"}});
    db.script(fmt::format(
        "{} INSERT INTO sheet(job, k, blank, segment, state) SELECT '{}', n, 1, 1, 'done' FROM c;",
        many(kSheets), long_job));
    db.script(fmt::format(
        "{} INSERT INTO attempt(id, job, k, blank, segment, first_stroke, strokes, device, "
        "device_session, operator, plan_sha256, invocation, created, started_at, ended, end_kind, "
        "bytes_taken, last_status) SELECT {}, '{}', 1 + n % 100, 1, n, 0, 5, 'sim:cameo3', '', "
        "'uid:4', '{}', '', 1, 1, 2, 'device_gone', 9, '' FROM c;",
        many(20'000), id_sql("A"), long_job, std::string(64, 'a')));
    db.script(many(20'000) + " INSERT INTO chunk(attempt, seq, path_from, path_to, state) SELECT " +
              id_sql("A") + ", 0, 0, 3, 'certain' FROM c;");
    db.script(many(20'000) +
              " INSERT INTO design(id, name, kind, owner, bytes, created, assets, media_type) "
              "SELECT printf('sha256-%064d', n), 'a', 'spec', 'uid:2', 1, 1, '[]', "
              "'application/json' FROM c;");
    db.script(many(20'000) +
              " INSERT INTO asset(id, bytes, created) SELECT printf('sha256-%064d', n), 1, 1 FROM "
              "c;");
    db.script(many(50'000) +
              " INSERT INTO event(time, kind, job, data) SELECT 1, 'notice', '', "
              "'{\"what\":\"nothing of note\"}' FROM c;");
    db.script(many(20'000) +
              " INSERT INTO idem(principal, key, request, status, body, etag, location, expires) "
              "SELECT 'uid:2', 'key-' || n, 'r', 201, '{}', '', '', 1 FROM c;");
    db.script(
        many(60'000) +
        " INSERT INTO usage(time, owner, operator, device, material, job, k, seconds, cut_mm, "
        "sheets) SELECT n, 'uid:' || n % 50, 'uid:4', 'sim:cameo3', 'paper-220', '', 1, 1, 1, "
        "1 FROM c;");
    db.script(
        many(5'000) +
        " INSERT INTO token(id, kind, name, role, principal, secret_sha256, created, expires) "
        "SELECT " +
        id_sql("T") +
        ", 'token', 'a', 'viewer', 'token:' || n, "
        "printf('%064d', n), 1, NULL FROM c;");
    db.script("COMMIT;");
  }
  std::map<std::string, std::string> indices_;
};

/// What a client sends.
struct Sent {
  std::string body{}, media_type{"application/json"}, query{};
  std::string file{};  ///< of an upload
  std::string path{};  ///< other than the usual one
  int status{};        ///< 0: whatever it is, below 500
};

class Asker {
 public:
  explicit Asker(World& world) : world_(world) {}

  Response ask(const Route& route, const Sent& sent) {
    const std::string path = sent.path.empty() ? path_of(route) : sent.path;
    const Answer<Target> target = read_target(path + sent.query);
    REQUIRE(target);
    const Match match = find_route(route.method, target->segments);
    REQUIRE(match.route == &route);
    auto request = std::make_shared<Request>();
    request->method = route.method;
    request->target = path + sent.query;
    request->id = "01JREQUEST";
    request->params = match.params;
    request->query = target->query;
    request->usual_page_items = route.usual_page_items;
    request->body = sent.file.empty() ? sent.body : "";
    request->media_type = sent.media_type;
    request->principal = world_.admin;
    if (!sent.file.empty()) request->upload = upload(sent.file);
    if (route.key != KeyRule::None)
      request->headers.push_back({"idempotency-key", fmt::format("turns-{:012}", ++number_)});
    if (route.match == MatchRule::OrAny) request->headers.push_back({"if-match", "*"});
    if (route.match == MatchRule::Required || route.match == MatchRule::OrNew)
      request->headers.push_back({"if-match", fmt::format("\"{}\"", rev_of(path))});
    auto state = std::make_shared<State>();
    const Reply reply([state](Response response) {
      const std::lock_guard lock(state->mutex);
      state->response = std::move(response);
      state->over.notify_all();
    });
    world_.thread().post(Lane::Asking, [&service = world_.service(), &route, request, reply] {
      static const HandlerContext context;
      dispatch(*request, route, service, context, reply);
    });
    std::unique_lock lock(state->mutex);
    REQUIRE(state->over.wait_for(lock, std::chrono::seconds(60),
                                 [&] { return state->response.has_value(); }));
    return std::move(*state->response);
  }

 private:
  struct State {
    std::mutex mutex;
    std::condition_variable over;
    std::optional<Response> response;
  };

  /// A path of the route about what is largest, or may be deleted.
  [[nodiscard]] std::string path_of(const Route& route) const {
    const bool removed = route.method == Method::Delete;
    const std::map<std::string, std::string> names{
        {"designs", world_.design},
        {"plans", removed ? fmt::format("7P{:024}", 2) : world_.long_plan},
        {"jobs", removed                                                  ? world_.ended_job
                 : route.path.find("/actions/") != std::string_view::npos ? world_.job
                                                                          : world_.long_job},
        {"tokens", world_.used_token},
        {"materials", "paper-220"},
        {"devices", world_.device}};
    std::string out, before;
    std::string_view rest = route.path;
    while (!rest.empty()) {
      rest.remove_prefix(1);
      const std::string_view part = rest.substr(0, rest.find('/'));
      rest.remove_prefix(part.size());
      const std::size_t open = part.find('{'), close = part.find('}');
      std::string value(part);
      if (open != std::string_view::npos) {
        const auto named = names.find(before);
        value = (named == names.end() ? "1" : named->second) + value.substr(close + 1);
      }
      before = part;
      out += "/" + value;
    }
    return out;
  }
  [[nodiscard]] std::int64_t rev_of(const std::string& path) {
    const std::string id = path.substr(path.find('/', 4) + 1, 26);
    return world_.on([&](LiveService& s) -> std::int64_t {
      if (path.starts_with("/v1/jobs/"))
        return s.jobs.find(id).map([](const Job& one) { return one.rev; }).value_or(1);
      if (path.starts_with("/v1/devices/")) return s.devices.find(world_.device).value().rev;
      return 1;
    });
  }
  [[nodiscard]] Upload upload(const std::string& text) {
    const std::string path = fmt::format("{}/incoming/turns-{}", world_.folder(), ++number_);
    testing::write_text(path, text);
    return {path, sha256_hex(text), text.size()};
  }

  World& world_;
  int number_{0};
};

/// 32 MB of a spec that names 460 000 assets that nobody has uploaded.
std::string invented_ids() {
  std::string text = "{\"popcut\":1,\"files\":[";
  for (int k = 0; text.size() < (32u << 20) - 100; ++k)
    text += fmt::format("\"sha256-{:064x}\",", k);
  return text + "\"\"]}";
}

/// As many small values as a body may hold.
std::string dense_body() {
  std::string text = "{\"options\":[";
  while (text.size() < (256u << 10) - 10) text += "[],";
  return text + "[]]}";
}

/// What is sent to a route besides nothing: the right words, and the largest queries.
std::vector<Sent> inputs_of(const Route& route, const World& world) {
  std::vector<Sent> all;
  if (route.body == BodyRule::Design) {
    all.push_back({.file = invented_ids()});
    all.push_back({.file = "{\"few\":1}", .status = 201});
    return all;
  }
  if (route.body == BodyRule::Asset) {
    all.push_back({.media_type = "model/stl", .file = std::string(32u << 20, 'x')});
    return all;
  }
  const std::string path(route.path);
  std::string right = "{}";
  if (path == "/v1/jobs") right = fmt::format(R"({{"plan":"{}","copies":1}})", world.long_plan);
  if (path.ends_with("/arm")) right = R"({"sheet":1,"blank":1})";
  if (path.ends_with("/start")) right = R"({"sheet":1})";
  if (path.ends_with("/hold") || path.ends_with("/release"))
    right = fmt::format(R"({{"job":"7J{:024}"}})", 9);
  if (path.ends_with("/move"))
    right = fmt::format(R"({{"job":"7J{:024}","before":"7J{:024}"}})", 9'000, 9);
  if (path.ends_with("/plan")) right = R"({"material":"paper-160"})";
  if (path == "/v1/preview" || path == "/v1/place")  // as long as a body may be
    right = nlohmann::json{{"spec", {{"name", std::string(250'000, 'n')}}},
                           {path == "/v1/place" ? "place" : "quality",
                            path == "/v1/place" ? "whole" : "exact"}}
                .dump();
  if (path.ends_with("/make")) right = R"({"way":"hand"})";
  if (path == "/v1/tokens") right = R"({"name":"turns","role":"viewer"})";
  if (route.method == Method::Patch)
    right = nlohmann::json{{"note", std::string(2000, 'n')}}.dump();
  all.push_back({.body = route.body == BodyRule::Json ? right : ""});
  if (route.body == BodyRule::Json) all.push_back({.body = dense_body()});
  const auto has = [&](const char* name) {
    return route.query.find(name) != std::string_view::npos;
  };
  if (has("limit")) all.push_back({.query = "?limit=200"});
  for (const char* name : {"owner", "device"})
    if (has(name)) {
      all.push_back({.query = fmt::format("?limit=200&{}=nobody", name)});
      all.push_back({.query = fmt::format("?limit=200&{}={}", name,
                                          name[0] == 'o' ? "uid:2" : "sim:cameo3")});
    }
  if (has("owner")) all.push_back({.query = "?limit=200&owner=uid:2&device=nobody"});
  if (has("state")) {
    all.push_back({.query = "?limit=200&state=cancelled&owner=nobody"});
    all.push_back({.query = "?limit=200&state=queued,planning,ready,armed,cutting,paused,"
                            "interrupted,done,failed,cancelled&owner=nobody"});
  }
  if (has("by")) all.push_back({.query = "?by=device&from=1970-01-01&to=2100-01-01"});
  if (has("after")) all.push_back({.query = "?after=0&limit=200"});
  return all;
}

}  // namespace

TEST_CASE("no request keeps the service's thread for more than 50 ms",
          "[daemon][service][turns][seconds]") {
  World world;
  Asker asker(world);
  std::map<std::string, TurnTime> longest;
  const auto take = [&](const Turns& turns) {
    for (const auto& [name, time] : turns.longest()) {
      TurnTime& known = longest[name];
      known.wall_s = std::max(known.wall_s, time.wall_s);
      known.cpu_s = std::max(known.cpu_s, time.cpu_s);
    }
  };
  world.thread().forget_turns();  // its start is measured elsewhere
  // What takes something away comes last.
  for (const bool removes : {false, true})
    for (const Route& route : routes()) {
      if ((route.method == Method::Delete) != removes) continue;
      CAPTURE(name_of(route.method), route.path);
      for (const Sent& sent : inputs_of(route, world)) {
        CAPTURE(sent.query, sent.body.substr(0, 100));
        Response response = asker.ask(route, sent);
        // HTTP does that on a thread that serves nothing else.
        if (response.make_body) response.body = response.make_body();
        INFO(response.body.substr(0, 300));
        CHECK((sent.status == 0 ? response.status < 500 : response.status == sent.status));
      }
    }
  // The sheet with the most strokes goes to the knife.
  world.on([&](LiveService& s) {
    const auto device = s.devices.find(world.device).value();
    return s.devices
        .act(world.admin, world.device, device.rev, {.action = "enable", .material = {}})
        .has_value();
  });
  const std::string big = world.create(world.design).value().id;
  world.act(big, JobAction::Arm).value();
  std::string why;
  const bool started = popcut::testing::comes_true([&] {
    const auto done = world.act(big, JobAction::Start);
    if (!done) why = done.error().detail;
    return done.has_value();
  });
  INFO(why);
  REQUIRE(started);
  REQUIRE(world.cutters.intend(world.device, 2));
  world.cutters.complete(world.device);
  CHECK(world.wait_for(big, JobState::Done).state == JobState::Done);
  // A plan of many sheets is stored.
  world.planner.sheets = kNewSheets;
  const std::string many = world.add_design("{\"sheets\":1}").value().id;
  const Job made = world.create(many).value();
  CHECK(world.wait_for(made.id, JobState::Ready).sheets_total == kNewSheets);
  world.on([](LiveService& s) { s.tick(); });
  take(world.thread().turns(Lane::Asking));
  take(world.thread().turns(Lane::Cutting));
  std::vector<std::pair<double, std::string>> sorted;
  for (const auto& [name, time] : longest) sorted.emplace_back(time.cpu_s, name);
  std::sort(sorted.rbegin(), sorted.rend());
  for (std::size_t k = 0; k < std::min<std::size_t>(sorted.size(), 8); ++k)
    std::printf("%7.1f ms of processor, %7.1f ms in all  %s\n", 1000 * sorted[k].first,
                1000 * longest[sorted[k].second].wall_s, sorted[k].second.c_str());
  for (const auto& [name, time] : longest) {
    CAPTURE(name, time.wall_s);
    CHECK(time.cpu_s < longest_turn_s());
  }
}

}  // namespace service_turns_test
