// SPDX-License-Identifier: MIT
#include <chrono>
#include <filesystem>
#include <thread>

#include <catch2/catch.hpp>

#include <fmt/format.h>

#include "daemon/fleet/fleet_files.hpp"
#include "daemon/fleet/fleet_schema.hpp"
#include "daemon/fleet/node_lease.hpp"
#include "daemon/fleet/postgres_database.hpp"
#include "tests/support/fault_proxy.hpp"
#include "tests/support/needs_postgres.hpp"
#include "tests/support/postgres_server.hpp"
#include "tests/support/process.hpp"
#include "tests/support/service_bench.hpp"

namespace two_nodes_test {

using namespace popcut;
using namespace popcut::daemon;
using popcut::testing::FaultProxy;
using popcut::testing::FreshDatabase;
using popcut::testing::PostgresServer;
using popcut::testing::ServiceBench;
using popcut::testing::shared_postgres;

namespace {

constexpr double kLease_s = 1.2;

/// A service as a node, behind a network that can be cut.
struct Node {
  Node(const FreshDatabase& database, const std::string& name, const std::string& site)
      : proxy(shared_postgres().socket()),
        bench(std::vector<std::string>{"sim:" + name}, false),
        url(proxy.url(database.name())) {
    bench.planner.sheets = 1;
    bench.options.fleet.node = name;
    bench.options.fleet.url = "http://" + name;
    bench.options.fleet.site = site;
    bench.options.fleet.lease_s = kLease_s;
    bench.options.fleet.beat_s = 0.1;
    bench.options.fleet.mark_s = 0;
    const PostgresDatabase::Options line{
        .url = url, .name = name, .connect_s = 1, .answer_s = 1, .again_s = 0.02};
    bench.database = [line] { return std::make_unique<PostgresDatabase>(line, false); };
    bench.opened_store = [line](Store& store) {
      store.share_files(make_fleet_files(store.database(), store.folder(), line));
    };
    REQUIRE(bench.start() == "");
  }
  [[nodiscard]] std::string device() const { return "sim:" + bench.options.fleet.node; }
  void partition() {
    proxy.refuse(true);
    proxy.cut_all();
  }
  void heal() { proxy.refuse(false); }
  FaultProxy proxy;
  ServiceBench bench;
  std::string url;
};

/// Two nodes of one fleet.
struct Fleet {
  explicit Fleet(const std::string& site_a = "", const std::string& site_b = "")
      : made(database.run_sql(std::string(fleet_schema()))),
        a(database, "a", site_a),
        b(database, "b", site_b) {}

  void tick() {
    for (Node* node : {&a, &b})
      if (node != down) node->bench.on([](LiveService& s) { s.tick(); });
  }
  /// Ticks both until `holds()`; false after a while.
  bool until(const std::function<bool()>& holds) {
    for (int i = 0; i < 600; ++i) {
      if (holds()) return true;
      tick();
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return false;
  }
  bool is(Node& node, const std::string& job, JobState state) {
    const Answer<Job> found = node.bench.on([&](LiveService& s) { return s.jobs.find(job); });
    return found && found->state == state;
  }
  /// A job of one sheet, known at both.
  std::string ready() {
    const Answer<Design> design = a.bench.add_design(fmt::format("{{\"card\":{}}}", ++cards));
    const std::string id = a.bench.create(design.value().id).value().id;
    REQUIRE(until([&] { return is(a, id, JobState::Ready) && is(b, id, JobState::Ready); }));
    return id;
  }
  /// On a busy computer nodes tick late, and lose their leases.
  Answer<Job> with_lease(const std::function<Answer<Job>()>& act) {
    Answer<Job> done = act();
    const auto is_late = [&] {
      return !done && (done.error().detail.starts_with("this node has no lease") ||
                       done.error().detail.starts_with("the lease of node"));
    };
    for (int i = 0; i < 100 && is_late(); ++i) {
      tick();
      done = act();
    }
    return done;
  }
  Answer<Job> arm(Node& node, const std::string& job, const std::string& device) {
    return with_lease(
        [&] { return node.bench.act(job, {.action = JobAction::Arm, .device = device}); });
  }
  /// Being cut at `node`, with strokes up to `last` sent.
  void start(Node& node, const std::string& job, std::int64_t last) {
    for (const JobAction action : {JobAction::Arm, JobAction::Start}) {
      const Answer<Job> done =
          action == JobAction::Arm
              ? arm(node, job, node.device())
              : with_lease([&] { return node.bench.act(job, JobAction::Start); });
      INFO((done ? "" : done.error().detail));
      REQUIRE(done);
    }
    REQUIRE(node.bench.cutters.intend(node.device(), last));
  }
  void kill(Node& node) {
    node.bench.crash();
    down = &node;
  }
  void restart(Node& node) {
    down = nullptr;
    REQUIRE(node.bench.start() == "");
  }
  /// The node that searches: on a busy computer the one that was asked may have lost its lease
  /// before.
  Node& searcher() {
    REQUIRE(until([&] { return a.bench.planner.started + b.bench.planner.started > 0; }));
    return b.bench.planner.started > 0 ? b : a;
  }
  Node& other(const Node& node) { return &node == &a ? b : a; }
  std::string sql(const std::string& text) const {
    return database.run_sql("SET search_path = popcut; " + text);
  }

  FreshDatabase database;
  std::string made;
  Node a, b;
  const Node* down{nullptr};
  int cards{0};
};

/// A search of a model that is made when the planner is let go.
std::string slow_search(Node& node) {
  const std::string bytes = "slow model";
  const Answer<Asset> model = node.bench.on([&](LiveService& s) {
    const std::string path = node.bench.folder() + "/incoming/asset";
    testing::write_text(path, bytes);
    return s.designs.add_asset(node.bench.student,
                               {path, sha256_hex(bytes), bytes.size(), "vase.obj"});
  });
  REQUIRE(model);
  const auto ask = [&](LiveService& s) {
    return s.searches.request(node.bench.student, {.model = model->id, .cards = 4, .marks = true});
  };
  // A node on a busy machine may be without its database for a moment.
  Answer<SearchRecord> asked = node.bench.on(ask);
  for (int k = 0; k < 100 && !asked; ++k) {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    asked = node.bench.on(ask);
  }
  REQUIRE(asked);
  return asked->id;
}

std::optional<SearchRecord> search_at(Node& node, const std::string& id) {
  const Answer<SearchRecord> found =
      node.bench.on([&](LiveService& s) { return s.searches.find(node.bench.student, id); });
  return found ? std::optional(*found) : std::nullopt;
}

bool is_found(Node& node, const std::string& id) {
  const auto record = search_at(node, id);
  return record && record->state == SearchState::Found;
}

}  // namespace

TEST_CASE("a job that is queued at one node is cut at the other", "[fleet]") {
  NEEDS_POSTGRES();
  Fleet fleet;
  std::vector<std::int64_t> heard_a, heard_b;
  for (auto [node, heard] : {std::pair{&fleet.a, &heard_a}, {&fleet.b, &heard_b}})
    node->bench.on([heard = heard](LiveService& s) {
      s.operations.listen([heard](const Event& event) {
        if (event.seq > 0) heard->push_back(event.seq);
      });
    });
  const std::string job = fleet.ready();
  // Only a person at the machine arms.
  const Answer<Job> refused = fleet.arm(fleet.a, job, fleet.b.device());
  REQUIRE_FALSE(refused);
  CHECK_THAT(refused.error().detail, Catch::Contains("http://b"));
  fleet.start(fleet.b, job, 2);
  REQUIRE(fleet.a.bench.act(job, JobAction::Pause));
  CHECK(fleet.a.bench.act(job, JobAction::Resume).error().kind == ProblemKind::StateConflict);
  fleet.b.bench.cutters.complete(fleet.b.device());
  CHECK(fleet.until([&] { return fleet.is(fleet.a, job, JobState::Done); }));
  CHECK(fleet.a.bench.cutters.cuts() == 0);
  CHECK(fleet.b.bench.cutters.cuts() == 1);
  // One began to listen before the other.
  const auto is_end_of = [](const auto& all, const auto& some) {
    return !some.empty() && all.size() >= some.size() &&
           std::equal(some.rbegin(), some.rend(), all.rbegin());
  };
  CHECK(fleet.until([&] { return is_end_of(heard_a, heard_b) || is_end_of(heard_b, heard_a); }));
  for (std::size_t i = 1; i < heard_a.size(); ++i) CHECK(heard_a[i] == heard_a[i - 1] + 1);
}

TEST_CASE("a job for a site is cut there, and not at the other nodes", "[fleet]") {
  NEEDS_POSTGRES();
  Fleet fleet("ground floor", "upstairs");
  const auto site_at = [&](Node& node) {
    const auto found = node.bench.on([&](LiveService& s) { return s.devices.find("sim:b"); });
    return found ? found->site : "";
  };
  REQUIRE(fleet.until([&] { return site_at(fleet.a) == "upstairs"; }));
  const std::string job = fleet.ready();
  const auto patched = [&](const JobPatch& patch) {
    return fleet.a.bench.on([&](LiveService& s) {
      return s.jobs.patch(fleet.a.bench.tutor, job, s.jobs.find(job)->rev, patch);
    });
  };
  REQUIRE(patched({.site = "upstairs"}));
  CHECK(fleet.a.bench.job(job).warnings.empty());
  // A device of that site may be named from anywhere, and no other.
  CHECK(patched({.device = fleet.b.device()}));
  const Answer<Job> other = patched({.device = fleet.a.device()});
  REQUIRE_FALSE(other);
  CHECK(other.error().errors.at(0).pointer == "/device");
  CHECK(patched({.device = ""}));
  const auto queued_for = [&](const std::string& device) {
    return fleet.a.bench.on(
        [&](LiveService& s) { return s.jobs.queue(device, PageRequest{})->items.size(); });
  };
  CHECK(queued_for(fleet.a.device()) == 0);
  CHECK(queued_for(fleet.b.device()) == 1);
  // Until: a slow machine may have to get its lease again first.
  const auto is_refused = [&](Node& node, const std::string& device, const std::string& why) {
    return fleet.until([&] {
      const Answer<Job> armed = fleet.arm(node, job, device);
      return !armed && armed.error().kind == ProblemKind::StateConflict &&
             armed.error().detail.find(why) != std::string::npos;
    });
  };
  CHECK(is_refused(
      fleet.a, fleet.a.device(),
      "sim:a is at site ground floor; the job is for site upstairs; change its site first"));
  // What this node believes of its own place does not matter to the database.
  fleet.sql("UPDATE device SET site='attic' WHERE id='sim:b'");
  CHECK(is_refused(fleet.b, "", "device sim:b is at site attic; job "));
  CHECK(fleet.is(fleet.b, job, JobState::Ready));
  fleet.sql("UPDATE device SET site='upstairs' WHERE id='sim:b'");
  fleet.tick();
  fleet.start(fleet.b, job, 2);
  CHECK_FALSE(patched({.site = ""}));
  fleet.b.bench.cutters.complete(fleet.b.device());
  CHECK(fleet.until([&] { return fleet.is(fleet.a, job, JobState::Done); }));
  CHECK(fleet.a.bench.cutters.cuts() == 0);
}

TEST_CASE("a job for a site is planned for the cutters that stand there", "[fleet]") {
  NEEDS_POSTGRES();
  Fleet fleet("ground floor", "upstairs");
  fleet.b.bench.cutters.unplug("sim:b");
  fleet.b.bench.cutters.plug("sim:b4", "idle", "cameo4");
  REQUIRE(fleet.until([&] {
    return fleet.a.bench.on([](LiveService& s) {
      const auto gone = s.devices.find("sim:b"), there = s.devices.find("sim:b4");
      return gone && gone->state == "absent" && there && there->state == "idle";
    });
  }));
  const std::string design = fleet.a.bench.add_design("{\"card\":1}").value().id;
  const auto machine_for = [&](const std::string& site) {
    JobCreate request;
    request.design = design;
    request.site = site;
    const Answer<Job> job = fleet.a.bench.on(
        [&](LiveService& s) { return s.jobs.create(fleet.a.bench.student, request); });
    REQUIRE(job);
    CHECK(fleet.until([&] { return fleet.is(fleet.a, job->id, JobState::Ready); }));
    return fleet.sql("SELECT machine FROM plan WHERE id='" + job->plan + "'");
  };
  CHECK(machine_for("") == "cameo3");
  CHECK(machine_for("ground floor") == "cameo3");
  CHECK(machine_for("upstairs") == "cameo4");
}

TEST_CASE("a cutter that is carried to another node is that node's", "[fleet]") {
  NEEDS_POSTGRES();
  Fleet fleet;
  const std::string device = fleet.a.device();
  const auto at = [&](Node& node) {
    return node.bench.on([&](LiveService& s) { return s.devices.find(device); });
  };
  REQUIRE(fleet.until([&] { return at(fleet.b).has_value(); }));
  fleet.a.bench.cutters.unplug(device);
  REQUIRE(fleet.until([&] { return at(fleet.b)->state == "absent"; }));
  fleet.b.bench.cutters.plug(device);
  REQUIRE(fleet.until([&] { return at(fleet.b)->state == "idle" && at(fleet.b)->node == "b"; }));
  REQUIRE(fleet.until([&] { return at(fleet.a)->state == "idle"; }));
  CHECK(at(fleet.a)->node == "b");
  CHECK(at(fleet.a)->node_url == "http://b");
  const std::string job = fleet.ready();
  CHECK_THAT(fleet.arm(fleet.a, job, device).error().detail, Catch::Contains("http://b"));
  CHECK(fleet.arm(fleet.b, job, device));
}

TEST_CASE("a cutter is enabled, disabled and reset only at its own node", "[fleet]") {
  NEEDS_POSTGRES();
  Fleet fleet;
  const auto at_a = [&] {
    return fleet.a.bench.on([](LiveService& s) { return s.devices.find("sim:b"); });
  };
  REQUIRE(fleet.until([&] { return at_a().has_value(); }));
  SECTION("it is plugged in") {}
  SECTION("it is unplugged") {
    fleet.b.bench.cutters.unplug("sim:b");
    REQUIRE(fleet.until([&] { return at_a()->state == "absent"; }));
  }
  for (const char* const action : {"disable", "enable", "reset"}) {
    const Answer<DeviceRecord> refused = fleet.a.bench.on([&](LiveService& s) {
      return s.devices.act(fleet.a.bench.admin, "sim:b", s.devices.find("sim:b")->rev,
                           {.action = action});
    });
    REQUIRE_FALSE(refused);
    CHECK(refused.error().detail == "sim:b is at b; enable, disable or reset it there: http://b");
  }
  CHECK(fleet.sql("SELECT node, enabled FROM device WHERE id='sim:b'") == "b|1");
}

TEST_CASE("a disabled cutter stays disabled when it is carried to another node", "[fleet]") {
  NEEDS_POSTGRES();
  Fleet fleet;
  const std::string device = fleet.a.device();
  const auto at_b = [&] {
    return fleet.b.bench.on([&](LiveService& s) { return s.devices.find(device); });
  };
  REQUIRE(fleet.a.bench.on([&](LiveService& s) {
    return s.devices.act(fleet.a.bench.admin, device, s.devices.find(device)->rev,
                         {.action = "disable"});
  }));
  const auto unplug = [&] {
    fleet.a.bench.cutters.unplug(device);
    REQUIRE(fleet.until(
        [&] { return fleet.sql("SELECT state FROM device WHERE id='sim:a'") == "absent"; }));
    fleet.sql("UPDATE device SET sheets_done=12 WHERE id='sim:a'");
  };
  SECTION("while the other node runs") {
    REQUIRE(fleet.until([&] { return at_b().has_value(); }));
    unplug();
    REQUIRE(fleet.until([&] { return at_b()->sheets_done == 12; }));
    fleet.b.bench.cutters.plug(device);
  }
  SECTION("while the other node is down") {
    fleet.kill(fleet.b);
    unplug();
    fleet.b.bench.cutters.plug(device);
    fleet.restart(fleet.b);
  }
  REQUIRE(fleet.until([&] { return at_b()->state == "idle" && at_b()->node == "b"; }));
  CHECK_FALSE(at_b()->enabled);
  CHECK(at_b()->sheets_done == 12);
  CHECK(fleet.until([&] {
    return fleet.sql("SELECT node, enabled, sheets_done FROM device WHERE id='sim:a'") == "b|0|12";
  }));
}

TEST_CASE("a node reads its cutters again if the database went away while it read them",
          "[fleet]") {
  NEEDS_POSTGRES();
  Fleet fleet;
  const std::string device = fleet.a.device();
  const auto found = [&] {
    return fleet.a.bench.on([&](LiveService& s) { return s.devices.find(device); });
  };
  REQUIRE(fleet.a.bench.on([&](LiveService& s) {
    return s.devices.act(fleet.a.bench.admin, device, s.devices.find(device)->rev,
                         {.action = "disable"});
  }));
  fleet.kill(fleet.a);
  fleet.a.proxy.cut_at("FROM device WHERE node", FaultProxy::Lost::Request);
  fleet.restart(fleet.a);
  REQUIRE_FALSE(fleet.a.proxy.cut_to_come());
  CHECK(fleet.until([&] { return found() && !found()->enabled; }));
}

TEST_CASE("a token that has expired gives no access while the database is away", "[fleet]") {
  NEEDS_POSTGRES();
  Fleet fleet;
  ServiceBench& bench = fleet.a.bench;
  const std::string token = bench.on([&](LiveService& s) {
    return s.access.create_token(bench.admin, "lab", Role::Operator, 600).value().text;
  });
  const auto who = [&] {
    return bench.on([&](LiveService& s) { return s.access.authenticate(token); });
  };
  REQUIRE(who());
  fleet.a.partition();
  REQUIRE(who());
  bench.monotonic_skew_ms += 601'000;
  CHECK_THROWS_AS(who(), StoreFault);
}

TEST_CASE("pause and cancel reach the knife from any node", "[fleet]") {
  NEEDS_POSTGRES();
  Fleet fleet;
  const std::string job = fleet.ready();
  fleet.start(fleet.b, job, 1);
  REQUIRE(fleet.a.bench.act(job, JobAction::Pause));
  CHECK(fleet.until([&] { return fleet.b.bench.cutters.pauses() > 0; }));
  REQUIRE(fleet.a.bench.act(job, JobAction::Cancel));
  CHECK(fleet.until([&] { return fleet.b.bench.cutters.cancels() == 1; }));
  fleet.b.bench.cutters.finish(fleet.b.device(), {.cancelled = true, .certain = 1});
  CHECK(fleet.until([&] { return fleet.is(fleet.a, job, JobState::Cancelled); }));
}

TEST_CASE("a node that dies with the knife down leaves its job interrupted", "[fleet]") {
  NEEDS_POSTGRES();
  Fleet fleet;
  const std::string job = fleet.ready();
  const std::string other = fleet.ready();
  REQUIRE(fleet.arm(fleet.a, other, fleet.a.device()));
  fleet.start(fleet.b, job, 2);
  fleet.kill(fleet.b);
  CHECK(fleet.is(fleet.a, job, JobState::Cutting));
  REQUIRE(fleet.until([&] { return fleet.is(fleet.a, job, JobState::Interrupted); }));
  // What was not marked as certain may have been cut, to the end of the sheet: it still may be.
  CHECK(testing::ledger(fleet.a.bench, job).not_sent.empty());
  CHECK(fleet.is(fleet.a, other, JobState::Armed));
  fleet.restart(fleet.b);
  // Its journal knows better: nothing after stroke 2 was sent.
  REQUIRE(fleet.until([&] { return testing::ledger(fleet.a.bench, job).not_sent.size() == 1; }));
  CHECK(testing::ledger(fleet.a.bench, job).not_sent.front().first == 3);
  REQUIRE(fleet.b.bench.act(job, JobAction::RetrySheet));
  fleet.start(fleet.b, job, 4);
  fleet.b.bench.cutters.complete(fleet.b.device());
  CHECK(fleet.is(fleet.b, job, JobState::Done));
  CHECK(fleet.sql("SELECT string_agg(blank || ' ' || end_kind, ', ' ORDER BY id) FROM attempt") ==
        "1 crash, 2 done");
}

TEST_CASE("a search whose node dies is made by another, and its cards are at all nodes",
          "[fleet]") {
  NEEDS_POSTGRES();
  Fleet fleet;
  const std::string id = slow_search(fleet.a);
  Node &first = fleet.searcher(), &second = fleet.other(first);
  // The others say who has it.
  CHECK(fleet.until([&] {
    return search_at(second, id)->doing == "searching at node " + first.bench.options.fleet.node;
  }));
  fleet.kill(first);
  REQUIRE(fleet.until([&] { return second.bench.planner.started > 0; }));
  CHECK(search_at(second, id)->request.cards == 4);
  second.bench.planner.release();
  REQUIRE(fleet.until([&] { return is_found(second, id); }));
  const int begun = first.bench.planner.started;
  fleet.restart(first);
  REQUIRE(fleet.until([&] { return is_found(first, id); }));
  for (Node* node : {&fleet.a, &fleet.b})
    CHECK(fleet.until([&] {
      return node->bench.on([&](LiveService& s) { return s.searches.picture(id, 2); }).has_value();
    }));
  CHECK(first.bench.planner.started == begun);
}

TEST_CASE("a search of a node that does not answer for a while is found once", "[fleet]") {
  NEEDS_POSTGRES();
  Fleet fleet;
  const std::string id = slow_search(fleet.a);
  Node &first = fleet.searcher(), &second = fleet.other(first);
  first.partition();
  REQUIRE(fleet.until([&] { return second.bench.planner.started > 0; }));
  const bool is_first = GENERATE(true, false);
  CAPTURE(is_first);
  if (is_first) second.bench.planner.release();
  if (is_first) REQUIRE(fleet.until([&] { return is_found(second, id); }));
  first.heal();
  for (Node* node : {&fleet.a, &fleet.b}) node->bench.planner.release();
  for (Node* node : {&fleet.a, &fleet.b}) REQUIRE(fleet.until([&] { return is_found(*node, id); }));
  CHECK(fleet.sql("SELECT count(*) FROM event WHERE data LIKE '%\"state\":\"found\"%'") == "1");
}

TEST_CASE("a search that ends just as the database is away is found all the same", "[fleet]") {
  NEEDS_POSTGRES();
  Fleet fleet;
  const std::string id = slow_search(fleet.a);
  Node &first = fleet.searcher(), &second = fleet.other(first);
  first.proxy.cut_at("COMMIT", FaultProxy::Lost::Request, "UPDATE search SET state");
  first.bench.planner.release();
  // If the node also loses its lease, on a busy computer, the other one searches again.
  REQUIRE(fleet.until([&] { return is_found(second, id) || second.bench.planner.started > 0; }));
  second.bench.planner.release();
  CHECK(fleet.until([&] { return is_found(second, id); }));
  CHECK_FALSE(first.proxy.cut_to_come());
}

TEST_CASE("a plan that ends just as the database is away is made all the same", "[fleet]") {
  NEEDS_POSTGRES();
  Fleet fleet;
  fleet.a.proxy.cut_at("COMMIT", FaultProxy::Lost::Request, "UPDATE plan SET planner_epoch=0");
  fleet.ready();
  CHECK_FALSE(fleet.a.proxy.cut_to_come());
}

TEST_CASE("a search of which several nodes died fails and says so", "[fleet]") {
  NEEDS_POSTGRES();
  Fleet fleet;
  const std::string id = slow_search(fleet.a);
  Node &first = fleet.searcher(), &second = fleet.other(first);
  const int begun = second.bench.planner.started;
  fleet.sql("UPDATE search SET begun = 3");
  fleet.kill(first);
  REQUIRE(fleet.until([&] { return search_at(second, id)->state == SearchState::Failed; }));
  CHECK_THAT(search_at(second, id)->error, Catch::Contains("popcutd ended 3 times"));
  CHECK(second.bench.planner.started == begun);
}

TEST_CASE("a cut goes on without the database and its end is told later", "[fleet]") {
  NEEDS_POSTGRES();
  Fleet fleet;
  const std::string job = fleet.ready();
  fleet.start(fleet.b, job, 0);
  fleet.b.partition();
  CHECK(fleet.b.bench.cutters.intend(fleet.b.device(), 3));
  REQUIRE(fleet.until([&] { return fleet.is(fleet.a, job, JobState::Interrupted); }));
  SECTION("it is still being cut when its node is back") {
    fleet.b.heal();
    REQUIRE(fleet.until([&] { return fleet.is(fleet.a, job, JobState::Cutting); }));
    fleet.b.bench.cutters.complete(fleet.b.device());
  }
  SECTION("it ends before its node is back") {
    fleet.b.bench.cutters.complete(fleet.b.device());
    CHECK(fleet.is(fleet.a, job, JobState::Interrupted));
    fleet.b.heal();
  }
  REQUIRE(fleet.until([&] { return fleet.is(fleet.a, job, JobState::Done); }));
  CHECK(fleet.b.bench.cutters.cuts() == 1);
  CHECK(fleet.b.bench.cutters.cancels() == 0);
}

TEST_CASE("what a person decided while a node was lost holds", "[fleet]") {
  NEEDS_POSTGRES();
  Fleet fleet;
  const std::string job = fleet.ready();
  fleet.start(fleet.b, job, 1);
  fleet.b.partition();
  REQUIRE(fleet.until([&] { return fleet.is(fleet.a, job, JobState::Interrupted); }));
  REQUIRE(fleet.a.bench.act(job, JobAction::RetrySheet));
  fleet.start(fleet.a, job, 4);
  fleet.b.heal();
  // The cut at the node that is back stops, and changes nothing but the record of its strokes.
  REQUIRE(fleet.until([&] { return fleet.b.bench.cutters.cancels() == 1; }));
  fleet.b.bench.cutters.finish(fleet.b.device(), {.cancelled = true, .certain = 1});
  fleet.a.bench.cutters.complete(fleet.a.device());
  REQUIRE(fleet.until([&] { return fleet.is(fleet.b, job, JobState::Done); }));
  CHECK(fleet.until([&] {
    return fleet.sql(
               "SELECT string_agg(blank || ' ' || node || ' ' || end_kind, ', ' "
               "ORDER BY blank) FROM attempt") == "1 b superseded, 2 a done";
  }));
}

TEST_CASE("a start whose answer is lost moves no knife and is taken back", "[fleet]") {
  NEEDS_POSTGRES();
  Fleet fleet;
  const std::string job = fleet.ready();
  REQUIRE(fleet.arm(fleet.b, job, fleet.b.device()));
  const bool is_stored = GENERATE(true, false);
  fleet.b.proxy.cut_at("COMMIT", is_stored ? FaultProxy::Lost::Answer : FaultProxy::Lost::Request,
                       "knife_start(");
  const Answer<Job> started = fleet.b.bench.act(job, JobAction::Start);
  REQUIRE_FALSE(started);
  CHECK(started.error().kind == ProblemKind::Unavailable);
  REQUIRE(fleet.until([&] {
    return fleet.is(fleet.a, job, JobState::Ready) || fleet.is(fleet.a, job, JobState::Armed);
  }));
  CHECK(fleet.b.bench.cutters.cuts() == 0);
  CHECK(fleet.sql("SELECT count(*) FROM attempt WHERE ended IS NULL") == "0");
  // The same blank may be started: nothing of it was cut.
  REQUIRE(fleet.until([&] {
    return fleet.is(fleet.b, job, JobState::Armed) ||
           fleet.arm(fleet.b, job, fleet.b.device()).has_value();
  }));
  REQUIRE(fleet.until([&] { return fleet.b.bench.act(job, JobAction::Start).has_value(); }));
  CHECK(fleet.b.bench.cutters.cuts() == 1);
  fleet.b.bench.cutters.complete(fleet.b.device());
}

TEST_CASE("a database that went back to before a start offers nothing again", "[fleet]") {
  NEEDS_POSTGRES();
  Fleet fleet;
  const std::string job = fleet.ready();
  const std::string event = fleet.sql("SELECT last FROM event_counter");
  // As if a copy from before the start were put in its place.
  const auto go_back = [&] {
    fleet.sql(
        "DELETE FROM chunk; DELETE FROM attempt; DELETE FROM arm; "
        "UPDATE job SET state='ready', device='', sheet=1, blank=1, segment=1, finished=NULL; "
        "UPDATE sheet SET state='ready', started=NULL; DELETE FROM event WHERE seq>" +
        event + "; UPDATE event_counter SET last=" + event);
  };
  fleet.start(fleet.b, job, 2);
  const auto until = std::chrono::steady_clock::now() + std::chrono::milliseconds(300);
  fleet.until([&] { return std::chrono::steady_clock::now() > until; });
  SECTION("it is still being cut: that goes on") {
    go_back();
    REQUIRE(fleet.until([&] { return fleet.is(fleet.a, job, JobState::Cutting); }));
    fleet.b.bench.cutters.complete(fleet.b.device());
    REQUIRE(fleet.until([&] { return fleet.is(fleet.a, job, JobState::Done); }));
    CHECK(fleet.b.bench.cutters.cuts() == 1);
  }
  SECTION("its node is off: nobody arms anything until it has told what it knows") {
    fleet.kill(fleet.b);
    go_back();
    REQUIRE(fleet.until([&] {
      const Answer<Job> armed = fleet.arm(fleet.a, job, fleet.a.device());
      return !armed && armed.error().detail.find("node b") != std::string::npos;
    }));
    fleet.restart(fleet.b);
    REQUIRE(fleet.until([&] { return fleet.is(fleet.a, job, JobState::Interrupted); }));
    REQUIRE(testing::ledger(fleet.a.bench, job).not_sent.size() == 1);
    CHECK(testing::ledger(fleet.a.bench, job).not_sent.front().first == 3);
  }
}

TEST_CASE("tokens and keys of requests hold at all nodes", "[fleet]") {
  NEEDS_POSTGRES();
  Fleet fleet;
  const NewToken token =
      fleet.a.bench
          .on([&](LiveService& s) {
            return s.access.create_token(fleet.a.bench.admin, "lab", Role::Operator, 3600);
          })
          .value();
  const auto who = [&] {
    return fleet.b.bench.on([&](LiveService& s) { return s.access.authenticate(token.text); });
  };
  REQUIRE(who());
  REQUIRE(fleet.a.bench.on(
      [&](LiveService& s) { return s.access.delete_token(fleet.a.bench.admin, token.record.id); }));
  CHECK_FALSE(who());
  int effects = 0;
  for (Node* node : {&fleet.a, &fleet.b, &fleet.a})
    CHECK(node->bench
              .on([&](LiveService& s) {
                return s.operations.once(
                    node->bench.tutor, {"a-key-of-its-own", "hash"},
                    [&]() -> Rendered { return {.status = ++effects, .body = {}}; });
              })
              ->status == 1);
  CHECK(effects == 1);
}

TEST_CASE("a node that dies just as its life is committed begins again at once", "[fleet]") {
  NEEDS_POSTGRES();
  FreshDatabase database;
  database.run_sql(std::string(fleet_schema()));
  FaultProxy proxy(shared_postgres().socket());
  popcut::testing::TempFolder place;
  const auto folder = StateFolder::open((place / "state").string());
  REQUIRE(folder);
  const auto begin = [&] {
    PostgresDatabase line({.url = proxy.url(database.name()), .connect_s = 1, .again_s = 0.02});
    NodeMark mark;
    NodeLease lease(line, **folder, mark, {.name = "a"});
    lease.begin();
    return mark.epoch;
  };
  const std::int64_t first = begin();
  const bool is_stored = GENERATE(true, false);
  proxy.cut_at("COMMIT", is_stored ? FaultProxy::Lost::Answer : FaultProxy::Lost::Request);
  CHECK_THROWS_AS(begin(), StoreFault);
  REQUIRE_FALSE(proxy.cut_to_come());
  const std::int64_t known = std::stoll(database.run_sql("SELECT epoch FROM popcut.node"));
  CHECK((known > first) == is_stored);
  CHECK(begin() > known);
  // Nothing of this looks as if the database had gone back.
  CHECK(database.run_sql("SELECT went_back FROM popcut.popcut_schema") == "0");
}

TEST_CASE("a node whose note of its last life is lost waits for the end of that lease", "[fleet]") {
  NEEDS_POSTGRES();
  Fleet fleet;
  const std::string note = fleet.a.bench.folder() + "/node";
  fleet.kill(fleet.a);
  std::filesystem::remove(note);
  fleet.restart(fleet.a);  // a service that did not begin would say why
  CHECK(fleet.until([&] {
    return fleet.sql("SELECT lease_until>clock_timestamp() AND epoch>" +
                     fleet.sql("SELECT epoch FROM node WHERE name='b'") +
                     " FROM node WHERE name='a'") == "t";
  }));
}

TEST_CASE("a node that has left in order does not begin again while its process ends", "[fleet]") {
  NEEDS_POSTGRES();
  Fleet fleet;
  fleet.b.bench.on([](LiveService& s) {
    s.leave_fleet();
    s.tick();
  });
  CHECK(fleet.sql("SELECT ended, lease_until FROM node WHERE name='b'") == "1|-infinity");
}

TEST_CASE("a cancel reaches the knife also if its event is lost on the way", "[fleet]") {
  NEEDS_POSTGRES();
  Fleet fleet;
  const std::string job = fleet.ready();
  fleet.start(fleet.b, job, 1);
  SECTION("one who listens fails") {
    fleet.b.bench.on([](LiveService& s) {
      s.operations.listen([](const Event& event) {
        if (event.data.find("\"state\":\"cutting\"") != std::string::npos)
          throw std::runtime_error("no room");
      });
    });
    REQUIRE(fleet.a.bench.act(job, JobAction::Cancel));
  }
  SECTION("the node was told of it when it could not look") {
    fleet.sql("UPDATE job SET asked='cancel', rev=rev+1 WHERE id='" + job + "'");
  }
  CHECK(fleet.until([&] { return fleet.b.bench.cutters.cancels() == 1; }));
  fleet.b.bench.cutters.finish(fleet.b.device(), {.cancelled = true, .certain = 1});
  CHECK(fleet.until([&] { return fleet.is(fleet.a, job, JobState::Cancelled); }));
}

TEST_CASE("a user whose role was taken away has none while the database is away", "[fleet]") {
  NEEDS_POSTGRES();
  Fleet fleet;
  constexpr gid_t kGroup = 4343;
  ServiceBench& bench = fleet.a.bench;
  LocalUsers users;
  users.groups[kGroup] = Role::Operator;
  bench.on([&](LiveService& s) { s.retune({.users = users}); });
  const Principal local{
      .name = "uid:4242@a", .role = Role::Operator, .user = LocalUser{4242, {kGroup}}};
  const std::string page = bench.on([&](LiveService& s) {
    return s.access.open_session(s.access.create_one_shot(local).value()).value().text;
  });
  const auto who = [&] {
    return bench.on([&](LiveService& s) { return s.access.authenticate(page); });
  };
  REQUIRE(who());
  bench.on([](LiveService& s) { s.retune({}); });
  fleet.a.partition();
  CHECK_THROWS_AS(who(), StoreFault);
}

}  // namespace two_nodes_test
