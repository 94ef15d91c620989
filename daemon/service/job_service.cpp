// SPDX-License-Identifier: MIT
#include "daemon/service/job_service.hpp"

#include <chrono>
#include <cstdlib>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "daemon/service/cut_desk.hpp"
#include "daemon/service/device_desk.hpp"
#include "daemon/service/figures.hpp"
#include "daemon/service/recovery.hpp"
#include "daemon/service/tokens.hpp"

namespace popcut::daemon {
namespace {

constexpr int kCheckpointPages = 500;
constexpr int kPrunedAtOnce = 500;
constexpr int kMostEvents = 1000;

ServiceOptions completed(ServiceOptions options) {
  using namespace std::chrono;
  if (!options.wall_ms)
    options.wall_ms = [] {
      return duration_cast<milliseconds>(system_clock::now().time_since_epoch()).count();
    };
  if (!options.monotonic_ms)
    options.monotonic_ms = [] {
      return duration_cast<milliseconds>(steady_clock::now().time_since_epoch()).count();
    };
  // Never the same for two runs: a service manager's own id is not kept over a fork in tests.
  if (options.invocation.empty()) {
    const char* const given = std::getenv("INVOCATION_ID");
    options.invocation =
        sha256_hex((given == nullptr ? "" : given) + random_bytes(16)).substr(0, 32);
  }
  if (!options.read_program)
    options.read_program = [](const std::string& folder, int) -> Result<EncodedProgram> {
      return fail(ErrorKind::Internal, folder, "nothing here reads programs");
    };
  return options;
}

class LiveService final : public JobService {
 public:
  LiveService(Store& store, ServiceThread& thread, Planner& planner, Cutters& cutters,
              ServiceOptions options)
      : options_(completed(std::move(options))),
        store_(store),
        thread_(thread),
        cutters_(cutters),
        memory_(store, options_),
        tokens_(memory_, options_),
        devices_(memory_, cutters, options_),
        materials_(memory_, options_),
        designs_(memory_, thread, planner, alive_),
        plans_({memory_, thread, planner, designs_, materials_, devices_, options_, alive_}),
        jobs_({memory_, thread, plans_, devices_, options_, alive_}),
        desk_({memory_, thread, cutters, jobs_, plans_, devices_, options_, alive_}),
        device_desk_({memory_, thread, cutters, devices_, jobs_, desk_, alive_}) {
    plans_.begun = [this](const std::string& plan) { jobs_.plan_begun(plan); };
    plans_.ended = [this](const std::string& plan) { jobs_.plan_ended(plan); };
    jobs_.live = [this](const std::string& job) { return desk_.live(job); };
    jobs_.knows_place = [this](const JobRow& row) { return desk_.knows_place(row, row.wish); };
    memory_.on_degraded = [this] { desk_.stop_cuts(); };
  }
  ~LiveService() override { cutters_.on_change({}); }

  Answer<void> begin();

  // Who asks
  std::optional<Principal> authenticate(std::string_view bearer) override {
    return tokens_.authenticate(bearer);
  }
  Answer<NewToken> create_token(const Principal& who, const std::string& name, Role role,
                                std::optional<int> lifetime_s) override {
    return tokens_.create(who, name, role, lifetime_s);
  }
  std::vector<TokenRecord> tokens() override { return tokens_.list(); }
  Answer<void> delete_token(const Principal& who, const std::string& id) override {
    return tokens_.remove(who, id);
  }
  Answer<std::string> create_one_shot(const Principal& who) override {
    return tokens_.create_one_shot(who);
  }
  Answer<NewToken> open_session(const std::string& one_shot) override {
    return tokens_.open_session(one_shot);
  }
  Answer<Rendered> once(const Principal& who, const IdempotentRequest& request,
                        const std::function<Rendered()>& effect) override;

  // Designs and plans
  void add_design(const Principal& who, Upload upload, std::string media_type, std::string name,
                  std::function<void(Answer<Design>)> done) override {
    designs_.add(who, std::move(upload), std::move(media_type), std::move(name), std::move(done));
  }
  Answer<Asset> add_asset(const Principal& who, Upload upload) override {
    return designs_.add_asset(who, upload);
  }
  Page<Design> designs(const PageWish& wish) override { return designs_.list(wish); }
  Answer<Design> design(const std::string& id) override { return designs_.find(id); }
  Answer<std::string> design_content(const std::string& id) override {
    return designs_.content(id);
  }
  Answer<void> delete_design(const Principal& who, const std::string& id) override {
    return memory_.change([&]() -> Answer<void> {
      Answer<void> removed = designs_.remove(who, id);
      if (removed) plans_.remove_all_of(id);
      return removed;
    });
  }
  Answer<PlanRecord> plan_design(const Principal& who, const PlanWish& wish) override;
  Answer<PlanRecord> plan(const std::string& id) override { return plans_.record(id); }
  Answer<void> delete_plan(const Principal& who, const std::string& id) override {
    return plans_.remove(who, id);
  }
  Answer<std::string> plan_file(const std::string& id, const std::string& name) override {
    return plans_.file(id, name);
  }
  void design_preview(const std::string& id,
                      std::function<void(Answer<std::string>)> done) override {
    designs_.preview(id, std::move(done));
  }

  // Jobs and the queue
  Answer<Job> create_job(const Principal& who, const JobCreate& wish) override {
    return jobs_.create(who, wish);
  }
  Answer<Page<Job>> jobs(const JobFilter& filter, const PageWish& wish) override {
    return jobs_.list(filter, wish);
  }
  Answer<Job> job(const std::string& id) override { return jobs_.find(id); }
  Answer<std::vector<SheetRecord>> sheets(const std::string& job) override {
    return jobs_.sheets(job);
  }
  Answer<Ledger> ledger(const std::string& job, int sheet) override {
    return jobs_.ledger(job, sheet);
  }
  Answer<Job> patch_job(const Principal& who, const std::string& id, std::int64_t if_match,
                        const JobPatch& wish) override {
    return jobs_.patch(who, id, if_match, wish);
  }
  Answer<Job> act(const Principal& who, const std::string& id, std::int64_t if_match,
                  const ActionWish& wish) override {
    return desk_.act(who, id, if_match, wish);
  }
  Answer<void> delete_job(const Principal& who, const std::string& id) override {
    return jobs_.remove(who, id);
  }
  Answer<Page<Job>> queue(const std::string& device, const PageWish& wish) override {
    return jobs_.queue(device, wish);
  }
  Answer<Job> hold(const Principal& who, const std::string& job, bool held) override {
    return jobs_.hold(who, job, held);
  }
  Answer<Job> move(const Principal& who, const std::string& job,
                   const std::string& before) override {
    return jobs_.move(who, job, before);
  }

  // Devices and materials
  std::vector<DeviceRecord> devices() override { return device_desk_.list(); }
  Answer<DeviceRecord> device(const std::string& id) override { return device_desk_.find(id); }
  Answer<DeviceRecord> act_on_device(const Principal& who, const std::string& id,
                                     std::int64_t if_match, const DeviceWish& wish) override {
    return device_desk_.act(who, id, if_match, wish);
  }
  std::vector<MaterialRecord> materials() override { return materials_.list(); }
  Answer<MaterialRecord> material(const std::string& id) override { return materials_.find(id); }
  Answer<MaterialRecord> put_material(const Principal& who, const std::string& id,
                                      std::int64_t if_match, const std::string& json) override {
    return materials_.put(who, id, if_match, json);
  }
  Answer<void> delete_material(const Principal& who, const std::string& id,
                               std::int64_t if_match) override {
    return materials_.remove(who, id, if_match);
  }

  // Events, figures, health
  Answer<std::vector<Event>> events(std::int64_t after, int limit, const std::string& job) override;
  std::int64_t last_event() override { return memory_.db().number("SELECT max(seq) FROM event"); }
  std::int64_t first_event() override { return memory_.db().number("SELECT min(seq) FROM event"); }
  void listen(std::function<void(const Event&)> listener) override {
    memory_.listen(std::move(listener));
  }
  std::vector<UsageRow> usage(std::optional<TimeMs> from, std::optional<TimeMs> to,
                              const std::string& by) override {
    return usage_by(memory_.db(), from, to, by);
  }
  Health health() override;
  std::string metrics() override {
    return metrics_text(memory_, jobs_.table(), devices_.list()) + cutters_.metrics();
  }
  Answer<std::string> backup(const Principal& who) override;
  Answer<std::string> check_integrity(const Principal& who) override;

  void stopping() override {
    desk_.stopping();
    plans_.stop();
  }
  void tick() override;
  void retune(ServiceTuning tuning) override {
    options_.queue_jobs = tuning.queue_jobs;
    options_.sheets_per_job = tuning.sheets_per_job;
    options_.device_materials = std::move(tuning.device_materials);
  }

 private:
  void prune();
  [[nodiscard]] Answer<void> idle_admin(const Principal& who) const;

  ServiceOptions options_;
  std::shared_ptr<void> alive_{std::make_shared<int>(0)};
  Store& store_;
  ServiceThread& thread_;
  Cutters& cutters_;
  Memory memory_;
  Tokens tokens_;
  DeviceBook devices_;
  MaterialBook materials_;
  DesignBook designs_;
  PlanningQueue plans_;
  JobBook jobs_;
  CutDesk desk_;
  DeviceDesk device_desk_;
};

Answer<void> LiveService::begin() {
  Answer<void> recovered = recover(memory_, jobs_);
  if (!recovered) return recovered;
  try {
    store_.mark_in_use();
  } catch (const StoreFault&) {
    // On a full disk popcutd starts too: to show what there is, and to let people make room.
    if (!store_.folder().free_reserve()) throw;
    memory_.note_full();
    store_.mark_in_use();
  }
  devices_.load();
  const std::weak_ptr<void> alive = alive_;
  cutters_.on_change([this, alive, thread = &thread_] {
    thread->post(ServiceThread::Lane::Asking, [this, alive] {
      if (const auto here = alive.lock()) device_desk_.look();
    });
  });
  device_desk_.look();
  // Plans that were stored just before the last run ended.
  std::vector<std::string> stored;
  {
    Rows rows = memory_.db().rows(
        "SELECT DISTINCT job.plan FROM job JOIN plan ON plan.id=job.plan WHERE job.state='queued' "
        "AND plan.state != 'pending'");
    while (rows.next()) stored.push_back(rows.text(0));
  }
  for (const std::string& plan : stored) jobs_.plan_ended(plan);
  plans_.pump();
  thread_.every(1000, [this, alive] {
    if (const auto here = alive.lock()) tick();
  });
  return {};
}

Answer<Rendered> LiveService::once(const Principal& who, const IdempotentRequest& request,
                                   const std::function<Rendered()>& effect) {
  if (request.key.empty()) return effect();
  // What is not kept is undone, so it is carried out of the transaction by hand.
  std::optional<Rendered> unkept;
  Answer<Rendered> answer = memory_.change([&]() -> Answer<Rendered> {
    unkept.reset();
    Database& db = memory_.db();
    Rows kept = db.rows(
        "SELECT request, status, body, etag, location, expires FROM idem WHERE principal=? AND "
        "key=?",
        who.name, request.key);
    if (kept.next() && kept.integer(5) > memory_.now()) {
      if (kept.text(0) != request.sha256)
        return refuse(ProblemKind::IdempotencyKeyReused,
                      "this Idempotency-Key was used for another request; take a new one");
      return Rendered{.status = kept.small(1),
                      .body = kept.text(2),
                      .etag = kept.text(3),
                      .location = kept.text(4),
                      .replayed = true};
    }
    Rendered rendered = effect();
    if (rendered.status >= 500 || rendered.status == 429) {
      unkept = std::move(rendered);
      return refuse(ProblemKind::Internal, "");
    }
    db.run(
        "INSERT OR REPLACE INTO idem(principal, key, request, status, body, etag, location, "
        "expires) VALUES(?, ?, ?, ?, ?, ?, ?, ?)",
        who.name, request.key, request.sha256, rendered.status, rendered.body, rendered.etag,
        rendered.location, memory_.now() + options_.keep_keys_ms);
    return rendered;
  });
  if (!answer && unkept) return std::move(*unkept);
  return answer;
}

Answer<PlanRecord> LiveService::plan_design(const Principal& who, const PlanWish& wish) {
  if (who.role < Role::Submitter)
    return refuse(ProblemKind::Forbidden, "designs are planned by a submitter");
  return memory_.change([&]() -> Answer<PlanRecord> {
    if (const auto room = memory_.accepts_work(); !room) return tl::unexpected(room.error());
    const Answer<PlanRow> plan = plans_.wish(wish);
    if (!plan) return tl::unexpected(plan.error());
    if (plan->state == PlanState::Pending)
      memory_.after_commit([this, id = plan->id] {
        plans_.hurry(id);
        plans_.pump();
      });
    return plans_.record(plan->id);
  });
}

Answer<std::vector<Event>> LiveService::events(std::int64_t after, int limit,
                                               const std::string& job) {
  return memory_.look([&]() -> Answer<std::vector<Event>> {
    if (!job.empty())
      if (const auto row = jobs_.row(job); !row) return tl::unexpected(row.error());
    std::vector<Event> all;
    const int most = std::clamp(limit, 1, kMostEvents);
    Rows rows = job.empty() ? memory_.db().rows(
                                  "SELECT seq, kind, time, job, data FROM event "
                                  "WHERE seq>? ORDER BY seq LIMIT ?",
                                  after, most)
                            : memory_.db().rows(
                                  "SELECT seq, kind, time, job, data FROM event "
                                  "WHERE seq>? AND job=? ORDER BY seq LIMIT ?",
                                  after, job, most);
    while (rows.next()) {
      Event event;
      event.seq = rows.integer(0);
      event.kind = rows.text(1);
      event.time = rows.integer(2);
      event.job = rows.text(3);
      event.data = rows.text(4);
      all.push_back(std::move(event));
    }
    return all;
  });
}

Service::Health LiveService::health() {
  Health health;
  health.disk_free_mb = store_.folder().free_bytes() >> 20;
  try {
    health.database = memory_.db().number("SELECT count(*) FROM tally") >= 0 && !memory_.degraded();
  } catch (const StoreFault& fault) {
    memory_.note(fault);
  }
  const Answer<void> work = memory_.accepts_work();
  health.accepts_work = work.has_value();
  if (!work) health.remark = work.error().detail;
  return health;
}

Answer<void> LiveService::idle_admin(const Principal& who) const {
  if (who.role < Role::Admin)
    return refuse(ProblemKind::Forbidden, "the database is looked after by an admin");
  // It takes the one thread that a cut's journal needs.
  if (desk_.cutting())
    return refuse(ProblemKind::StateConflict, "a sheet is being cut; try again when none is");
  return {};
}

Answer<std::string> LiveService::backup(const Principal& who) {
  if (const auto may = idle_admin(who); !may) return tl::unexpected(may.error());
  const std::string name = fmt::format("popcut-{:%Y%m%dT%H%M%S}Z-{}.db",
                                       fmt::gmtime(static_cast<std::time_t>(memory_.now() / 1000)),
                                       sha256_hex(random_bytes(8)).substr(0, 6));
  auto made = memory_.look(
      [&]() -> Answer<std::string> { return back_up(memory_.db(), store_.folder(), name); });
  if (!made) return made;
  (void)memory_.change([&]() -> Answer<void> {
    memory_.audit(who.name, "backup", name, "");
    return {};
  });
  return made;
}

Answer<std::string> LiveService::check_integrity(const Principal& who) {
  if (const auto may = idle_admin(who); !may) return tl::unexpected(may.error());
  return memory_.look([&]() -> Answer<std::string> {
    std::string verdict;
    for (const char* check : {"PRAGMA integrity_check(20)", "PRAGMA foreign_key_check"}) {
      Rows rows = memory_.db().rows(check);
      while (rows.next()) {
        const std::string line = rows.text(0);
        if (line == "ok") continue;
        verdict += line + "\n";
      }
    }
    return verdict.empty() ? std::string("ok") : verdict;
  });
}

// A few at a time, so that nobody waits for it.
void LiveService::prune() {
  (void)memory_.change([&]() -> Answer<void> {
    const TimeMs now = memory_.now();
    Database& db = memory_.db();
    db.run(
        "DELETE FROM idem WHERE (principal, key) IN (SELECT principal, key FROM idem WHERE "
        "expires<=? LIMIT ?)",
        now, kPrunedAtOnce);
    // The last one stays, for the numbers to go on from it.
    db.run(
        "DELETE FROM event WHERE seq IN (SELECT seq FROM event ORDER BY seq LIMIT ?) AND time<? "
        "AND seq<(SELECT max(seq) FROM event)",
        kPrunedAtOnce, now - options_.keep_events_ms);
    db.run("DELETE FROM token WHERE expires<?", now - options_.keep_keys_ms);
    return {};
  });
}

void LiveService::tick() {
  memory_.recover_disk();
  desk_.tick();
  device_desk_.look();
  if (memory_.degraded()) return;
  if (!memory_.full()) jobs_.catch_up();
  plans_.pump();
  tokens_.tidy();
  try {
    if (memory_.db().wal_pages() > kCheckpointPages) memory_.db().checkpoint(false);
    const bool old = memory_.db().number("SELECT EXISTS(SELECT 1 FROM idem WHERE expires<=?)",
                                         memory_.now()) != 0 ||
                     memory_.db().number("SELECT time FROM event ORDER BY seq LIMIT 1") <
                         memory_.now() - options_.keep_events_ms;
    if (old && !memory_.full()) prune();
  } catch (const StoreFault& fault) {
    memory_.note(fault);
  }
}

}  // namespace

Result<std::unique_ptr<JobService>> make_service(Store& store, ServiceThread& thread,
                                                 Planner& planner, Cutters& cutters,
                                                 ServiceOptions options) {
  Result<std::unique_ptr<JobService>> made =
      fail(ErrorKind::Internal, "", "the service's thread has ended");
  // A database that passed its checks may still hold what makes no sense.
  const auto give_up = [&](bool damaged, const std::string& why) {
    store.give_up();
    made = damaged ? fail(ErrorKind::Malformed, "", store.set_aside_as("is damaged: " + why))
                   : fail(ErrorKind::Unwritable, store.folder().at("popcut.db"), why);
  };
  thread.run(ServiceThread::Lane::Asking, [&] {
    try {
      auto service =
          std::make_unique<LiveService>(store, thread, planner, cutters, std::move(options));
      if (const Answer<void> begun = service->begin(); begun)
        made = std::move(service);
      else
        give_up(begun.error().kind == ProblemKind::Internal, begun.error().detail);
    } catch (const StoreFault& fault) {
      give_up(fault.kind() != FaultKind::Full && fault.kind() != FaultKind::Io, fault.what());
    }
  });
  return made;
}

}  // namespace popcut::daemon
