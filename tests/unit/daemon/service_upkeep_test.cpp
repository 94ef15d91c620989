// SPDX-License-Identifier: MIT
#include <filesystem>

#include <catch2/catch.hpp>

#include "daemon/service/side_thread.hpp"
#include "tests/support/service_bench.hpp"

namespace service_upkeep_test {

using namespace popcut;
using namespace popcut::daemon;
using popcut::testing::ServiceBench;
using popcut::testing::write_text;

TEST_CASE("tokens give access until they are revoked", "[daemon][service]") {
  ServiceBench bench;
  const NewToken token =
      bench
          .on([&](LiveService& s) {
            return s.access.create_token(bench.admin, "lab", Role::Operator, 3600);
          })
          .value();
  CHECK(token.text.size() == 73);
  const auto who = [&](const std::string& text) {
    return bench.on([&](LiveService& s) { return s.access.authenticate(text); });
  };
  REQUIRE(who(token.text));
  CHECK(who(token.text)->role == Role::Operator);
  CHECK(who(token.text)->name == "token:" + token.record.id);
  std::string wrong = token.text;
  wrong.back() = wrong.back() == 'A' ? 'B' : 'A';
  CHECK_FALSE(who(wrong));
  CHECK_FALSE(who(""));
  CHECK_FALSE(who("pc_' OR 1=1"));
  // Of the secret only its digest is stored.
  const std::string secret = token.text.substr(30);
  if (SqliteDatabase* const file = bench.store().file()) {
    bench.on([&](LiveService&) { file->checkpoint(false); });
    CHECK(read_whole(bench.folder() + "/popcut.db", 1 << 26)->find(secret) == std::string::npos);
  }
  bench.skew_ms = 3'601'000;
  CHECK_FALSE(who(token.text));
  bench.skew_ms = 0;
  CHECK(bench.on([&](LiveService& s) { return s.access.tokens().size(); }) == 1);
  CHECK(bench.on([&](LiveService& s) {
    return s.access.delete_token(bench.tutor, token.record.id).error().kind;
  }) == ProblemKind::Forbidden);
  REQUIRE(bench.on(
      [&](LiveService& s) { return s.access.delete_token(bench.admin, token.record.id); }));
  CHECK_FALSE(who(token.text));
  CHECK(bench.on([&](LiveService& s) {
    return s.access.create_token(bench.tutor, "x", Role::Admin, {}).error().kind;
  }) == ProblemKind::Forbidden);
}

TEST_CASE("a page's one-time code opens one session and expires after a minute",
          "[daemon][service]") {
  ServiceBench bench;
  const auto word = [&] {
    Principal tutor = bench.tutor;
    tutor.user = LocalUser{0, {}};
    tutor.name += ServiceBench::machine();
    return bench.on([&](LiveService& s) { return s.access.create_one_shot(tutor).value(); });
  };
  const auto open = [&](const std::string& one) {
    return bench.on([&](LiveService& s) { return s.access.open_session(one); });
  };
  const std::string first = word();
  const NewToken session = open(first).value();
  CHECK(open(first).error().kind == ProblemKind::Unauthenticated);
  const auto who = [&] {
    return bench.on([&](LiveService& s) { return s.access.authenticate(session.text); });
  };
  REQUIRE(who());
  CHECK(who()->name == bench.tutor.name + ServiceBench::machine());
  CHECK(bench.on([&](LiveService& s) { return s.access.tokens().empty(); }));
  const std::string late = word();
  bench.monotonic_skew_ms = 61'000;
  CHECK_FALSE(open(late));
  // Each use moves its end on; without use it ends.
  for (int hour = 1; hour <= 30; hour += 8) {
    bench.skew_ms = hour * 3'600'000LL;
    CHECK(who());
  }
  bench.skew_ms += 13 * 3'600'000LL;
  CHECK_FALSE(who());
}

TEST_CASE("materials can be changed and reset", "[daemon][service]") {
  ServiceBench bench;
  const auto put = [&](const std::string& id, std::int64_t rev, const std::string& json) {
    return bench.on([&](LiveService& s) { return s.materials.put(bench.admin, id, rev, json); });
  };
  const auto count = bench.on([](LiveService& s) { return s.materials.list().size(); });
  CHECK(count > 2);
  const MaterialRecord thick =
      put("our-card", 0, R"j({"like":"paper-220","thickness_mm":0.5})j").value();
  CHECK(thick.rev == 1);
  CHECK(thick.json.find("\"thickness_mm\":0.5") != std::string::npos);
  CHECK(thick.json.find("dash_mm") != std::string::npos);  // what it inherits is filled in
  CHECK(put("our-card", 0, "{}").error().kind == ProblemKind::Stale);
  CHECK(put("our-card", 1, R"({"thickness_mm":-1})").error().kind == ProblemKind::Validation);
  CHECK(put("our-card", 1, R"({"thikness_mm":1})").error().kind == ProblemKind::Validation);
  const auto thin = put("our-card", 1, R"j({"like":"paper-220","dashes":{"gap_mm":-1}})j").error();
  CHECK(thin.errors.at(0).pointer == "/dashes/gap_mm");
  CHECK(thin.detail.find("table") == std::string::npos);
  CHECK(put("our-card", 1, "[1,").error().kind == ProblemKind::Validation);
  CHECK(put("../etc", 0, "{}").error().kind == ProblemKind::Validation);
  CHECK(put("our-card", 1, R"({"like":"paper-220","thickness_mm":0.6})").value().rev == 2);
  CHECK(bench.on([](LiveService& s) { return s.materials.list().size(); }) == count + 1);
  CHECK(put("paper-220", 1, R"({"like":"paper-220","thickness_mm":0.3})").value().rev == 2);
  CHECK(bench.on([&](LiveService& s) {
    return s.materials.remove(bench.admin, "paper-160", 1).error().kind;
  }) == ProblemKind::StateConflict);
  REQUIRE(
      bench.on([&](LiveService& s) { return s.materials.remove(bench.admin, "paper-220", 2); }));
  CHECK(bench.on([](LiveService& s) { return s.materials.find("paper-220")->built_in; }));
  CHECK(bench.on([](LiveService& s) { return s.materials.find("papier").error().kind; }) ==
        ProblemKind::NotFound);
}

TEST_CASE("a revision of a material that was deleted does not come again", "[daemon][service]") {
  ServiceBench bench;
  const auto put = [&](std::int64_t rev, const std::string& json) {
    return bench.on(
        [&](LiveService& s) { return s.materials.put(bench.admin, "our-card", rev, json); });
  };
  const auto remove = [&](std::int64_t rev) {
    return bench.on(
        [&](LiveService& s) { return s.materials.remove(bench.admin, "our-card", rev); });
  };
  const auto count = bench.on([](LiveService& s) { return s.materials.list().size(); });
  const std::int64_t old = put(0, R"({"like":"paper-220","thickness_mm":0.5})").value().rev;
  REQUIRE(remove(old));
  CHECK(remove(old).error().kind == ProblemKind::NotFound);
  CHECK(put(old, R"({"like":"paper-220"})").error().kind == ProblemKind::NotFound);
  CHECK(bench.on([](LiveService& s) { return s.materials.list().size(); }) == count);
  const std::int64_t fresh = put(0, R"({"like":"paper-220","thickness_mm":0.6})").value().rev;
  CHECK(fresh > old);
  // Whoever read the first row does not change the second one.
  CHECK(put(old, R"({"like":"paper-220","thickness_mm":0.7})").error().kind == ProblemKind::Stale);
  CHECK(remove(old).error().kind == ProblemKind::Stale);
  CHECK(remove(fresh));
}

TEST_CASE("events are numbered without gaps and old ones are removed", "[daemon][service]") {
  ServiceBench bench;
  std::vector<Event> heard;
  std::mutex mutex;
  bench.on([&](LiveService& s) {
    s.operations.listen([&](const Event& event) {
      const std::lock_guard lock(mutex);
      heard.push_back(event);
    });
  });
  const Job ready = bench.ready_job();
  bench.started(ready.id);
  for (int i = 0; i < 50; ++i)
    bench.cutters.progress(bench.device,
                           {.phase = SessionPhase::Cutting, .strokes_done = 1, .strokes = 5});
  bench.cutters.complete(bench.device);
  const auto events =
      bench.on([](LiveService& s) { return s.operations.events(0, 1000, "").value(); });
  std::int64_t before = 0;
  for (const Event& event : events) {
    CHECK(event.seq == before + 1);
    CHECK(event.kind != "progress");
    before = event.seq;
  }
  CHECK(bench.on([](LiveService& s) { return s.operations.last_event(); }) == before);
  {
    const std::lock_guard lock(mutex);
    int progress = 0;
    std::int64_t last = 0;
    for (const Event& event : heard) {
      progress += event.kind == "progress" ? 1 : 0;
      if (event.seq == 0) continue;
      CHECK(event.seq > last);
      last = event.seq;
    }
    CHECK(progress >= 1);
    CHECK(progress <= 4);  // fifty were reported
  }
  CHECK(bench.on([&](LiveService& s) {
    return s.operations.events(0, 1000, ready.id).value().size();
  }) >= 5);
  CHECK(bench.on([&](LiveService& s) {
    return s.operations.events(before - 2, 1, "").value().at(0).seq;
  }) == before - 1);
  // A month later only the last one is left, for the numbers to go on.
  bench.monotonic_skew_ms = bench.skew_ms = 31LL * 86'400'000;
  bench.on([](LiveService& s) { s.tick(); });
  CHECK(bench.on([](LiveService& s) { return s.operations.first_event(); }) == before);
  REQUIRE(bench.create(ready.design));
  CHECK(bench.on([](LiveService& s) { return s.operations.last_event(); }) > before);
}

TEST_CASE("ids and numbers keep growing when the clock is set back a year",
          "[alone][daemon][service]") {
  ServiceBench bench;
  const Job first = bench.ready_job();
  bench.stop();
  bench.skew_ms = -366LL * 86'400'000;
  REQUIRE(bench.start() == "");
  const Job second = bench.create(first.design).value();
  CHECK(second.id > first.id);
  CHECK(bench.on([](LiveService& s) { return s.jobs.list({}, {})->items.size(); }) == 2);
  bench.started(second.id);
  bench.cutters.complete(bench.device);
  CHECK(bench.job(second.id).sheet == 2);
}

TEST_CASE("an admin backs the database up and checks it while nothing is cut",
          "[alone][daemon][service]") {
  ServiceBench bench;
  const Job ready = bench.ready_job();
  const std::string copy = bench.backup(bench.admin).value();
  {
    SqliteDatabase database({.path = copy, .create = false, .exclusive_wal = false});
    CHECK(database.number("SELECT count(*) FROM job") == 1);
  }
  CHECK(bench.check_integrity().value() == "ok");
  CHECK(bench.backup(bench.tutor).error().kind == ProblemKind::Forbidden);
  bench.started(ready.id);
  CHECK(bench.backup(bench.admin).error().kind == ProblemKind::StateConflict);
  const std::string metrics = bench.on([](LiveService& s) { return s.operations.metrics(); });
  CHECK(metrics.find("popcut_jobs{state=\"cutting\"} 1\n") != std::string::npos);
  CHECK(metrics.find("popcut_db_commit_seconds_count") != std::string::npos);
  // Each wait is counted with the next one, or at the end.
  CHECK(metrics.find("popcut_stream_wait_seconds_count 0\n") != std::string::npos);
  REQUIRE(bench.cutters.intend(bench.device, 0));
  bench.cutters.complete(bench.device);
  const std::string later = bench.on([](LiveService& s) { return s.operations.metrics(); });
  CHECK(later.find("popcut_stream_wait_seconds_count 0\n") == std::string::npos);
  CHECK(later.find("popcut_stream_wait_seconds_longest 0.000000\n") == std::string::npos);
}

TEST_CASE("no knife is armed until all of a database that was not closed is checked",
          "[alone][daemon][service]") {
  ServiceBench bench;
  const std::string id = bench.ready_job().id;
  bench.crash();
  bench.check_later = true;
  REQUIRE(bench.start() == "");
  const auto early = bench.act(id, JobAction::Arm);
  REQUIRE_FALSE(early);
  CHECK(early.error().kind == ProblemKind::Unavailable);
  CHECK(early.error().detail.find("arm again in a moment") != std::string::npos);
  CHECK(bench.create(bench.job(id).design));  // all else goes on
  bench.on([](LiveService& service) { service.check_ended(""); });
  CHECK(bench.act(id, JobAction::Arm));
  // What is found damaged is not written to any more.
  bench.crash();
  REQUIRE(bench.start() == "");
  bench.on([](LiveService& service) { service.check_ended("is damaged: a page"); });
  const auto late = bench.act(id, JobAction::Arm);
  REQUIRE_FALSE(late);
  CHECK(late.error().detail.find("is damaged: a page") != std::string::npos);
  CHECK_FALSE(bench.create(bench.job(id).design));
  CHECK_FALSE(bench.on([](LiveService& s) { return s.operations.health().database; }));
}

TEST_CASE("too little disk space refuses new work with a reason", "[daemon][service]") {
  ServiceBench bench(false);
  bench.options.least_free_bytes = std::uint64_t{1} << 60;
  REQUIRE(bench.start() == "");
  CHECK(bench.add_design("{}").error().kind == ProblemKind::DiskFull);
  CHECK_FALSE(bench.on([](LiveService& s) { return s.operations.health().accepts_work; }));
  CHECK(bench.on([](LiveService& s) { return s.operations.health().database; }));
}

TEST_CASE("a moved state folder is reported as such and not as a full disk", "[daemon][service]") {
  ServiceBench bench;
  const auto design = bench.add_design("{\"card\":1}").value();
  const std::string away = bench.folder() + "-away";
  std::filesystem::rename(bench.folder(), away);
  const auto refused = bench.on([&](LiveService& s) {
    return s.jobs.create(bench.student, {.design = design.id, .plan = {}});
  });
  REQUIRE_FALSE(refused);
  CHECK(refused.error().kind == ProblemKind::Unavailable);
  CHECK(refused.error().detail.find(bench.folder()) != std::string::npos);
  const auto health = bench.on([](LiveService& s) { return s.operations.health(); });
  CHECK_FALSE(health.accepts_work);
  CHECK(health.disk_free_mb > 0);
  CHECK(health.remark.find("move it back") != std::string::npos);
  // Another folder in its place is not the one that is held.
  std::filesystem::create_directory(bench.folder());
  write_text(bench.folder() + "/lock", "");
  CHECK_FALSE(bench.on([](LiveService& s) { return s.operations.health().accepts_work; }));
  std::filesystem::remove_all(bench.folder());
  std::filesystem::rename(away, bench.folder());
  const Job job = bench.create(design.id).value();
  CHECK(bench.wait_for(job.id, JobState::Ready).state == JobState::Ready);
}

TEST_CASE("requests of a running cut precede those of people", "[daemon][service]") {
  ServiceThread thread;
  std::vector<int> order;
  std::mutex gate;
  gate.lock();
  thread.post(ServiceThread::Lane::Asking, [&] { const std::lock_guard wait(gate); });
  for (int i = 0; i < 3; ++i)
    thread.post(ServiceThread::Lane::Asking, [&, i] { order.push_back(10 + i); });
  for (int i = 0; i < 3; ++i)
    thread.post(ServiceThread::Lane::Cutting, [&, i] { order.push_back(i); });
  gate.unlock();
  CHECK(thread.run(ServiceThread::Lane::Asking,
                   [&] { thread.run(ServiceThread::Lane::Asking, [&] { order.push_back(99); }); }));
  CHECK(order == std::vector{0, 1, 2, 10, 11, 12, 99});
  int ticks = 0;
  thread.every(1, [&] { ++ticks; });
  for (int i = 0; i < 10'000; ++i) {
    int seen = 0;
    thread.run(ServiceThread::Lane::Asking, [&] { seen = ticks; });
    if (seen > 2) break;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  thread.stop();
  CHECK(ticks > 2);
  CHECK_FALSE(thread.post(ServiceThread::Lane::Cutting, [] {}));
  CHECK_FALSE(thread.run(ServiceThread::Lane::Cutting, [] {}));
}

TEST_CASE("periodic work waits once however long the thread is busy", "[daemon][service]") {
  ServiceThread thread;
  std::mutex gate;
  gate.lock();
  thread.post(ServiceThread::Lane::Asking, [&] { const std::lock_guard wait(gate); });
  for (int i = 0; i < 20; ++i)
    thread.post(ServiceThread::Lane::Asking,
                [] { std::this_thread::sleep_for(std::chrono::milliseconds(2)); });
  std::size_t waiting = 100;
  thread.post(ServiceThread::Lane::Asking, [&] { waiting = thread.waiting(); });
  thread.every(1, [] {});
  gate.unlock();
  thread.run(ServiceThread::Lane::Asking, [] {});
  thread.stop();
  CHECK(waiting <= 2);  // the periodic work, and the work that was waited for
}

TEST_CASE("a backup ends when a sheet begins to be cut", "[alone][daemon][service]") {
  ServiceBench bench;
  const Job ready = bench.ready_job();
  REQUIRE(bench.act(ready.id, JobAction::Arm));
  bench.on([&](LiveService&) {
    bench.store().database().script(
        "INSERT INTO audit(time, principal, action, subject, detail) "
        "VALUES(0, '', 'large', '', hex(zeroblob(3000000)))");
  });
  const Answer<std::string> made = bench.told<std::string>([&](LiveService& s, auto done) {
    s.operations.backup(bench.admin, done);
    const Job armed = s.jobs.find(ready.id).value();
    REQUIRE(s.cutting.act(bench.tutor, ready.id, armed.rev, {.action = JobAction::Start}));
  });
  REQUIRE_FALSE(made);
  CHECK(made.error().kind == ProblemKind::StateConflict);
  CHECK(std::filesystem::is_empty(bench.folder() + "/backups"));
  bench.cutters.complete(bench.device);
  CHECK(bench.backup(bench.admin));
}

TEST_CASE("work of the service that fails is logged and the next runs", "[daemon][service]") {
  std::vector<std::string> lines;
  ServiceThread thread([&](const std::string& line) { lines.push_back(line); });
  thread.post(ServiceThread::Lane::Asking, [] { throw std::runtime_error("no room for it"); });
  CHECK(thread.run(ServiceThread::Lane::Asking, [] {}));
  thread.stop();
  REQUIRE(lines.size() == 1);
  CHECK(lines.front().find("no room for it") != std::string::npos);
}

TEST_CASE("what cannot be removed is logged and what is not there is not", "[daemon][service]") {
  testing::TempFolder folder;
  write_text((folder / "file").string(), "");
  ServiceThread thread;
  std::vector<std::string> lines;
  SideThread side_thread(thread, [&](const std::string& line) { lines.push_back(line); });
  side_thread.remove((folder / "absent").string());
  CHECK(lines.empty());
  side_thread.remove((folder / "file" / "inside").string());
  REQUIRE(lines.size() == 1);
  CHECK(lines.front().find("inside cannot be removed: Not a directory") != std::string::npos);
}

}  // namespace service_upkeep_test
