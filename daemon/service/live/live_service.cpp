// SPDX-License-Identifier: MIT
#include "daemon/service/live/live_service.hpp"

#include <chrono>
#include <cstdlib>
#include <filesystem>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "daemon/model/wall_clock.hpp"
#include "daemon/service/calendar.hpp"
#include "daemon/service/live/cut_dispatcher.hpp"
#include "daemon/service/live/device_dispatcher.hpp"
#include "daemon/service/live/fleet_watch.hpp"
#include "daemon/service/live/program_shelf.hpp"
#include "daemon/service/repositories/recovery.hpp"
#include "daemon/service/repositories/reports.hpp"
#include "daemon/service/repositories/search_repository.hpp"
#include "daemon/service/side_thread.hpp"
#include "daemon/service/tokens.hpp"
#include "daemon/store/sliced_copy.hpp"

namespace popcut::daemon {
namespace {

constexpr int kCheckpointPages = 500;
constexpr std::size_t kEndedJournals = 50;
constexpr int kPrunedAtOnce = 500;
constexpr int kMostEvents = 1000;
// An event whose time is so far ahead was stored while the clock was wrong.
constexpr std::int64_t kAfter_ms = 24 * 3'600'000;
constexpr std::int64_t kUsageAtOnce = 10'000;
constexpr int kPagesAtOnce = 500;

ServiceOptions completed(ServiceOptions options) {
  using namespace std::chrono;
  if (!options.wall_ms) options.wall_ms = wall_clock_ms;
  if (!options.user_name) options.user_name = login_name;
  if (!options.monotonic_ms)
    options.monotonic_ms = [] {
      return duration_cast<milliseconds>(steady_clock::now().time_since_epoch()).count();
    };
  // Each run gets an id of its own. The service manager's id is not enough: in tests, several runs
  // have the same environment.
  if (options.invocation.empty()) {
    const char* const given = std::getenv("INVOCATION_ID");
    options.invocation =
        sha256_hex((given == nullptr ? "" : given) + random_bytes(16)).substr(0, 32);
  }
  if (!options.read_program)
    options.read_program = [](const std::string& folder, int) -> Result<StoredProgram> {
      return fail(ErrorKind::Internal, folder, "no reader of programs is set");
    };
  return options;
}

/// The parts of the service. A part refers only to parts that are declared before it; what it needs
/// of later ones are functions, which the constructor sets.
struct Parts {
  Parts(Store& disk, ServiceThread& service_thread, Planner& planner, Cutters& all_cutters,
        ServiceOptions given)
      : options(completed(std::move(given))),
        raw(disk),
        thread(service_thread),
        cutters(all_cutters),
        store(disk, options),
        calendar(store, options),
        intents(disk.folder(), disk.file() == nullptr),
        titles(store, options),
        tokens(store, titles, options),
        registry(store, cutters, options),
        materials(store, options),
        chores(thread, [this](const std::string& line) { store.log(line); }),
        reading(thread),
        designs(store, post, planner, options.previewer, chores),
        plans({store, post, planner, chores, designs, materials, registry, options}),
        searches({store, post, planner, chores, designs, plans, options}),
        jobs({store, post, plans, registry, titles, options}),
        programs(reading, options.read_program),
        cuts({store, post, cutters, jobs, registry, intents, options}),
        dispatcher({store, jobs, plans, programs, registry, intents, cuts, cutters, options}),
        device_dispatcher({store, post, cutters, registry, jobs, cuts, dispatcher}) {
    if (store.in_fleet()) {
      fleet.emplace(FleetWatch::Parts{store, jobs, registry, intents, cuts, dispatcher, options});
      // The id of the run is in each journal, so a journal shows from which machine and folder it
      // is.
      options.invocation = store.node().mark() + options.invocation.substr(0, 16);
    }
    if (store.in_fleet() && options.fleet.has_database_clock) {
      options.wall_ms = [this, own = options.wall_ms] {
        const TimeMs now = own();
        return now + fleet->lease().ahead_ms(now);
      };
    }
    designs.material_row = [this](const std::string& name) {
      const Answer<MaterialRecord> found = materials.find(name.empty() ? kUsualMaterial : name);
      return found ? found->json : std::string();
    };
    designs.owner_removed = [this](const std::string& design) { plans.remove_unowned(design); };
    designs.asset_owner_removed = [this](const std::string& asset) {
      searches.remove_unowned(asset);
    };
    plans.begun = [this](const std::string& plan) { jobs.plan_begun(plan); };
    plans.progressed = [this](const std::string& plan, const PlanningPhase& phase) {
      jobs.plan_progressed(plan, phase);
    };
    plans.ended = [this](const std::string& plan) { jobs.plan_ended(plan); };
    jobs.live = [this](const std::string& job) {
      const Cut* const cut = cuts.of_job(job);
      return cut == nullptr ? nullptr : &cut->live;
    };
    jobs.next_actions = [this](const JobRow& row) { return dispatcher.next_actions(row); };
    jobs.disarmed = [this](const std::string& job) { dispatcher.forget_arm(job); };
    jobs.arm_left_ms = [this](const std::string& job) { return dispatcher.arm_left_ms(job); };
    jobs.knows_place = [this](const JobRow& row) {
      return dispatcher.knows_place(row, row.requested_device);
    };
    store.on_degraded = [this] { cuts.stop_all(); };
    calendar.moved = [this](std::int64_t by_ms) {
      store.db().run("UPDATE idem SET expires=expires+?", by_ms);
    };
  }
  ServiceOptions options;
  std::shared_ptr<void> alive{std::make_shared<int>(0)};
  Store& raw;
  ServiceThread& thread;
  Poster post{thread, alive};  ///< for as long as these parts live
  Cutters& cutters;
  ServiceStore store;
  Calendar calendar;
  IntentJournals intents;
  PrincipalTitles titles;
  Tokens tokens;
  DeviceRegistry registry;
  MaterialRepository materials;
  SideThread chores, reading;  ///< two, so that a long chore does not hold up a START
  DesignRepository designs;
  PlanningQueue plans;
  SearchRepository searches;
  JobRepository jobs;
  ProgramShelf programs;
  RunningCuts cuts;
  CutDispatcher dispatcher;
  DeviceDispatcher device_dispatcher;
  std::optional<FleetWatch> fleet;
};

/// A base class, so that the parts are made before the service that refers to them.
struct PartsHolder {
  Parts parts_;
};

class AssembledService final : private PartsHolder, public Operations, public LiveService {
 public:
  AssembledService(Store& disk, ServiceThread& thread, Planner& planner, Cutters& cutters,
                   ServiceOptions options)
      : PartsHolder{{disk, thread, planner, cutters, std::move(options)}},
        LiveService({parts_.tokens, parts_.designs, parts_.plans, parts_.searches, parts_.jobs,
                     parts_.dispatcher, parts_.device_dispatcher, parts_.materials, *this}) {}
  ~AssembledService() override { parts_.cutters.on_change({}); }

  Answer<void> begin();

  Answer<Rendered> once(const Principal& who, const IdempotentRequest& request,
                        const std::function<Rendered()>& effect) override;
  Answer<std::vector<Event>> events(std::int64_t after, int limit, const std::string& job) override;
  std::int64_t last_event() override {
    return parts_.store.db().number("SELECT max(seq) FROM event");
  }
  std::int64_t first_event() override {
    return parts_.store.db().number("SELECT min(seq) FROM event");
  }
  void listen(std::function<void(const Event&)> listener) override {
    parts_.store.listen(std::move(listener));
  }
  void usage(std::optional<TimeMs> from, std::optional<TimeMs> to, const std::string& by,
             std::function<void(Answer<std::vector<UsageRow>>)> done) override;
  ServiceHealth health() override;
  std::string metrics() override {
    const std::string own = turns_text(parts_.thread) + parts_.cutters.metrics();
    if (!parts_.fleet)
      return metrics_text(parts_.store, parts_.jobs.table(), parts_.registry.list()) + own;
    // The metrics of the node do not need the database.
    try {
      return metrics_text(parts_.store, parts_.jobs.table(), parts_.registry.list()) + own +
             parts_.fleet->metrics();
    } catch (const StoreFault& fault) {
      parts_.store.handle_fault(fault);
      return own + parts_.fleet->metrics();
    }
  }
  void backup(const Principal& who, std::function<void(Answer<std::string>)> done) override;
  void check_integrity(const Principal& who,
                       std::function<void(Answer<std::string>)> done) override;

  void stopping() override {
    parts_.cuts.stopping();
    parts_.plans.stop();
    parts_.searches.stop();
  }
  void on_fleet_notice(const std::string& notice) override;
  void leave_fleet() override {
    if (parts_.fleet) parts_.fleet->end();
  }
  void tick() override;
  void check_ended(const std::string& damage) override { parts_.store.check_ended(damage); }
  void retune(ServiceTuning tuning) override {
    parts_.options.queue_jobs = tuning.queue_jobs;
    parts_.options.jobs_each = tuning.jobs_each;
    parts_.options.plans_each = tuning.plans_each;
    parts_.options.sheets_per_job = tuning.sheets_per_job;
    parts_.options.device_materials = std::move(tuning.device_materials);
    parts_.options.users = std::move(tuning.users);
    parts_.tokens.users_changed();
  }

 private:
  Answer<void> begin_alone();
  Answer<void> begin_in_fleet();
  void share_again();
  void on_remote_event(const Event& event);
  void after_remote_events();
  [[nodiscard]] bool has_old_rows();
  void prune();
  [[nodiscard]] Answer<void> may_copy(const Principal& who) const;
  [[nodiscard]] Answer<void> check_idle() const;
  void in_slices(const char* name, const std::function<Answer<bool>()>& step,
                 const std::function<void(const Answer<bool>&)>& done);
  void copy(const std::string& path, std::function<Answer<std::string>()> finish,
            std::function<void(Answer<std::string>)> done);
  bool copying_{false};
  // Whether other nodes changed devices or queued jobs since the last `after_remote_events`.
  bool others_changed_{false}, others_queued_{false};
};

Answer<void> AssembledService::begin() {
  const Answer<void> begun = parts_.fleet ? begin_in_fleet() : begin_alone();
  if (!begun) return begun;
  parts_.cutters.on_change(
      [this, post = parts_.post] { post([this] { parts_.device_dispatcher.refresh(); }); });
  parts_.device_dispatcher.refresh();
  if (!parts_.fleet) {
    parts_.jobs.plans_ended_before();
    parts_.plans.pump();
    parts_.searches.pump();
  }
  parts_.thread.every(1000, [this, alive = std::weak_ptr<void>(parts_.alive)] {
    if (const auto here = alive.lock()) tick();
  });
  return {};
}

// If the database does not answer, the service begins all the same: it shows the cutters, and what
// they cut is finished.
Answer<void> AssembledService::begin_in_fleet() {
  parts_.fleet->on_begun = [this] {
    parts_.tokens.users_changed();
    parts_.registry.load();
    // Before `refresh`, because a cutter of another node may be plugged in here now.
    parts_.registry.load_others();
    parts_.device_dispatcher.refresh();
    parts_.jobs.plans_ended_before();
    parts_.plans.pump();
    parts_.searches.pump();
    share_again();
  };
  parts_.store.on_remote_event = [this](const Event& event) { on_remote_event(event); };
  parts_.store.after_remote_events = [this] { after_remote_events(); };
  return parts_.fleet->begin();
}

// Stores large assets in the shared database. The last run of this node accepted them, but ended
// before it stored them there.
void AssembledService::share_again() {
  SharedFiles* const files = &parts_.store.files();
  for (const std::string& id : all_of(
           parts_.store.db().rows("SELECT id FROM asset WHERE NOT EXISTS (SELECT 1 FROM blob WHERE "
                                  "blob.path='assets/' || asset.id)"),
           first_text))
    parts_.chores.run([files, id, place = parts_.raw.folder().at("assets/" + id)] {
      std::error_code ignored;
      if (std::filesystem::exists(place, ignored)) (void)files->keep("assets/" + id);
    });
}

// An event of another node may be about a cut or a plan of this one.
void AssembledService::on_remote_event(const Event& event) {
  if (event.kind == "device") others_changed_ = true;
  if (event.kind == "job") {
    parts_.cuts.apply_remote_request(event.job);
    const std::string state = text_in(event, "state");
    if (state == name_of(JobState::Queued)) others_queued_ = true;
    if (state == name_of(JobState::Cancelled))
      (void)parts_.store.read([&]() -> Answer<void> {
        if (const Answer<JobRow> row = parts_.jobs.row(event.job))
          parts_.plans.cancel_if_unwanted(row->plan);
        return {};
      });
  }
}

void AssembledService::after_remote_events() {
  if (std::exchange(others_changed_, false))
    (void)parts_.store.read([&]() -> Answer<void> {
      parts_.registry.load_others();
      return {};
    });
  if (std::exchange(others_queued_, false)) parts_.plans.pump();
}

void AssembledService::on_fleet_notice(const std::string& notice) {
  name_turn("news of the fleet");
  if (!parts_.fleet) return;
  if (notice == kAccessChanged) return parts_.tokens.forget_known();
  try {
    parts_.store.deliver_new_events();
  } catch (const StoreFault& fault) {
    parts_.store.handle_fault(fault);
  }
}

Answer<void> AssembledService::begin_alone() {
  Answer<void> recovered = recover(parts_.store, parts_.jobs, parts_.intents);
  if (!recovered) return recovered;
  try {
    parts_.raw.mark_in_use();
  } catch (const StoreFault&) {
    // popcutd starts on a full disk too, so that people see the reason and can free space.
    if (!parts_.raw.folder().free_reserve()) throw;
    parts_.store.note_full();
    parts_.raw.mark_in_use();
  }
  parts_.calendar.load();
  parts_.tokens.users_changed();
  parts_.registry.load();
  return {};
}

Answer<Rendered> AssembledService::once(const Principal& who, const IdempotentRequest& request,
                                        const std::function<Rendered()>& effect) {
  if (request.key.empty()) return effect();
  // A response that is not kept: the transaction is rolled back, and this is returned.
  std::optional<Rendered> unkept;
  Answer<Rendered> answer = parts_.store.change([&]() -> Answer<Rendered> {
    unkept.reset();
    Database& db = parts_.store.db();
    // In a fleet two nodes may get the same request at the same time.
    db.hold(fmt::format("idem {} {}", who.name, request.key));
    Rows kept = db.rows(
        "SELECT request, status, body, etag, location, expires FROM idem WHERE principal=? AND "
        "key=?",
        who.name, request.key);
    if (kept.next() && kept.integer(5) > parts_.calendar.now()) {
      if (kept.text(0) != request.sha256)
        return refuse(ProblemKind::IdempotencyKeyReused,
                      "this Idempotency-Key was used for another request; use a new one");
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
    db.put("idem(principal, key, request, status, body, etag, location, expires)", "principal, key",
           who.name, request.key, request.sha256, rendered.status, rendered.body, rendered.etag,
           rendered.location, parts_.calendar.now() + parts_.options.keep_keys_ms);
    return rendered;
  });
  if (!answer && unkept) return std::move(*unkept);
  return answer;
}

Answer<std::vector<Event>> AssembledService::events(std::int64_t after, int limit,
                                                    const std::string& job) {
  return parts_.store.read([&]() -> Answer<std::vector<Event>> {
    if (!job.empty())
      if (const auto row = parts_.jobs.row(job); !row) return tl::unexpected(row.error());
    const int most = std::clamp(limit, 1, kMostEvents);
    Rows rows = job.empty() ? parts_.store.db().rows(
                                  "SELECT seq, kind, time, job, data FROM event "
                                  "WHERE seq>? ORDER BY seq LIMIT ?",
                                  after, most)
                            : parts_.store.db().rows(
                                  "SELECT seq, kind, time, job, data FROM event "
                                  "WHERE seq>? AND job=? ORDER BY seq LIMIT ?",
                                  after, job, most);
    return all_of(std::move(rows), event_of);
  });
}

ServiceHealth AssembledService::health() {
  ServiceHealth health;
  health.disk_free_mb = parts_.raw.folder().free_bytes() >> 20;
  try {
    health.database =
        parts_.store.db().number("SELECT count(*) FROM tally") >= 0 && !parts_.store.degraded();
  } catch (const StoreFault& fault) {
    parts_.store.handle_fault(fault);
    health.waits = parts_.store.in_fleet();
    if (health.waits) health.remark = parts_.store.problem_of(fault).detail;
  }
  const Answer<void> work = parts_.store.accepts_work();
  health.accepts_work = work.has_value() && !health.waits;
  if (!work) health.remark = work.error().detail;
  return health;
}

void AssembledService::usage(std::optional<TimeMs> from, std::optional<TimeMs> to,
                             const std::string& by,
                             std::function<void(Answer<std::vector<UsageRow>>)> done) {
  auto sum = std::make_shared<std::optional<UsageSum>>();
  const Answer<void> begun = parts_.store.read([&]() -> Answer<void> {
    sum->emplace(parts_.store.db(), from, to, by);
    return {};
  });
  if (!begun) return done(tl::unexpected(begun.error()));
  in_slices(
      "sums of usage",
      [this, sum] {
        return parts_.store.read([&]() -> Answer<bool> { return (*sum)->step(kUsageAtOnce); });
      },
      [sum, done = std::move(done)](const Answer<bool>& all) {
        if (!all) return done(tl::unexpected(all.error()));
        done((*sum)->rows());
      });
}

// Calls `step` in this turn and in further turns until it returns true or a problem, then `done`.
// Other work has its turns in between.
void AssembledService::in_slices(const char* name, const std::function<Answer<bool>()>& step,
                                 const std::function<void(const Answer<bool>&)>& done) {
  name_turn(name);
  Answer<bool> over = step();
  if (!over || *over) return done(over);
  parts_.post([this, name, step, done] { in_slices(name, step, done); });
}

Answer<void> AssembledService::may_copy(const Principal& who) const {
  if (who.role < Role::Admin)
    return refuse(ProblemKind::Forbidden, "only an admin may back up or check the database");
  if (parts_.raw.file() == nullptr)
    return refuse(ProblemKind::StateConflict,
                  "the database is a PostgreSQL that all nodes share; back it up with PostgreSQL's "
                  "own tools: docs/fleet.md says how");
  if (const auto free = check_idle(); !free) return free;
  if (copying_)
    return refuse(ProblemKind::StateConflict, "another backup or check is running; try again");
  return {};
}

// A copy takes disk space that the journal of a cut may need.
Answer<void> AssembledService::check_idle() const {
  if (!parts_.cuts.any()) return {};
  return refuse(ProblemKind::StateConflict, "a sheet is being cut; try again when it is finished");
}

// Copies the database to `path` in slices, then runs `finish` on another thread; `done` gets its
// result.
void AssembledService::copy(const std::string& path, std::function<Answer<std::string>()> finish,
                            std::function<void(Answer<std::string>)> done) {
  auto copy = std::make_shared<std::unique_ptr<SlicedCopy>>();
  const Answer<void> begun = parts_.store.read([&]() -> Answer<void> {
    remove_tree(path);
    *copy = std::make_unique<SlicedCopy>(*parts_.raw.file(), path);
    return {};
  });
  if (!begun) return done(tl::unexpected(begun.error()));
  copying_ = true;
  in_slices(
      "pages of a copy",
      [this, copy]() -> Answer<bool> {
        if (const auto free = check_idle(); !free) return tl::unexpected(free.error());
        // Only a damaged database is a fault of the database. Any other fault may be one of the
        // disk that gets the copy.
        try {
          return (*copy)->step(kPagesAtOnce);
        } catch (const StoreFault& fault) {
          if (fault.kind() == FaultKind::Corrupt) parts_.store.handle_fault(fault);
          return tl::unexpected(parts_.store.problem_of(fault));
        } catch (const std::bad_alloc&) {
          return refuse(ProblemKind::Unavailable, "out of memory");
        }
      },
      [this, copy, path, finish = std::move(finish),
       done = std::move(done)](const Answer<bool>& whole) {
        copy->reset();
        auto result = std::make_shared<Answer<std::string>>(
            refuse(ProblemKind::Unavailable, "the copy of the database could not be finished"));
        if (!whole) *result = tl::unexpected(whole.error());
        parts_.chores.run(
            [result, path, finish, is_whole = whole.has_value()] {
              try {
                if (is_whole) *result = finish();
              } catch (const std::exception& fault) {
                *result = refuse(ProblemKind::Unavailable, fault.what());
              }
              remove_tree(path);
              remove_tree(path + "-wal");
            },
            [this, result, done, alive = std::weak_ptr<void>(parts_.alive)] {
              const auto here = alive.lock();
              if (!here) return;
              copying_ = false;
              done(std::move(*result));
            });
      });
}

void AssembledService::backup(const Principal& who, std::function<void(Answer<std::string>)> done) {
  if (const auto may = may_copy(who); !may) return done(tl::unexpected(may.error()));
  const std::string name =
      fmt::format("popcut-{:%Y%m%dT%H%M%S}Z-{}.db",
                  fmt::gmtime(static_cast<std::time_t>(parts_.store.now() / 1000)),
                  sha256_hex(random_bytes(8)).substr(0, 6));
  const std::string place = parts_.raw.folder().at("backups/" + name);
  const std::string fresh = parts_.raw.folder().at("backups/.new-" + name);
  copy(
      fresh,
      [fresh, place]() -> Answer<std::string> {
        finish_copy(fresh);
        if (const Result<void> kept = keep_file(fresh, place); !kept)
          return refuse(ProblemKind::DiskFull, message(kept.error()));
        return place;
      },
      [this, who, name, done = std::move(done)](Answer<std::string> made) {
        if (made)
          (void)parts_.store.change([&]() -> Answer<void> {
            parts_.store.audit(who.name, "backup", name, "");
            return {};
          });
        done(std::move(made));
      });
}

void AssembledService::check_integrity(const Principal& who,
                                       std::function<void(Answer<std::string>)> done) {
  if (const auto may = may_copy(who); !may) return done(tl::unexpected(may.error()));
  const std::string fresh = parts_.raw.folder().at("backups/.new-check.db");
  copy(
      fresh, [fresh]() -> Answer<std::string> { return verdict_on_copy(fresh); }, std::move(done));
}

// Whether `prune` has something to delete. That may be an event from the future, which was stored
// while the clock was wrong.
bool AssembledService::has_old_rows() {
  const TimeMs now = parts_.calendar.now();
  Database& db = parts_.store.db();
  if (db.number("SELECT EXISTS(SELECT 1 FROM idem WHERE expires<=?)", now) != 0) return true;
  const TimeMs first = db.number("SELECT time FROM event ORDER BY seq LIMIT 1");
  return first < now - parts_.options.keep_events_ms ||
         first > parts_.calendar.latest() + kAfter_ms;
}

// Deletes a few old rows at a time, so that nobody waits long.
void AssembledService::prune() {
  (void)parts_.store.change([&]() -> Answer<void> {
    const TimeMs now = parts_.calendar.now();
    Database& db = parts_.store.db();
    db.run(
        "DELETE FROM idem WHERE (principal, key) IN (SELECT principal, key FROM idem WHERE "
        "expires<=? LIMIT ?)",
        now, kPrunedAtOnce);
    // Delete all events before the first recent one, so that there is never a gap: an event whose
    // clock was wrong goes with its neighbours. The last event stays, since numbers continue from
    // it.
    db.run(
        "WITH first AS (SELECT seq, time FROM event ORDER BY seq LIMIT ?) "
        "DELETE FROM event WHERE seq IN (SELECT seq FROM first) AND "
        "seq<coalesce((SELECT min(seq) FROM first WHERE time BETWEEN ? AND ?), "
        "(SELECT max(seq) FROM event))",
        kPrunedAtOnce, now - parts_.options.keep_events_ms, parts_.calendar.latest() + kAfter_ms);
    db.run("DELETE FROM token WHERE expires<?", now - parts_.options.keep_keys_ms);
    db.run("DELETE FROM session WHERE expires<?", now - parts_.options.keep_keys_ms);
    return {};
  });
}

void AssembledService::tick() {
  name_turn("tick");
  parts_.store.recover_disk();
  if (parts_.fleet) parts_.fleet->tick();
  parts_.dispatcher.tick();
  parts_.cuts.tick();
  parts_.device_dispatcher.refresh();
  if (parts_.store.degraded()) return;
  if (!parts_.store.full()) parts_.jobs.catch_up();
  parts_.plans.pump();
  parts_.searches.pump();
  parts_.tokens.tidy();
  if (!parts_.store.full()) parts_.calendar.tick();
  try {
    SqliteDatabase* const file = parts_.raw.file();
    const bool many_ended = parts_.intents.waiting() > kEndedJournals;
    if (file == nullptr) {
      if (parts_.intents.waiting() > 0) parts_.intents.checkpointed();
    } else if (parts_.raw.checked() && (file->wal_pages() > kCheckpointPages || many_ended)) {
      if (file->checkpoint(false)) parts_.intents.checkpointed();
    }
    if (!parts_.store.full() && has_old_rows()) prune();
  } catch (const StoreFault& fault) {
    parts_.store.handle_fault(fault);
  }
}

}  // namespace

Result<std::unique_ptr<LiveService>> make_service(Store& store, ServiceThread& thread,
                                                  Planner& planner, Cutters& cutters,
                                                  ServiceOptions options) {
  Result<std::unique_ptr<LiveService>> made =
      fail(ErrorKind::Internal, "", "the service's thread has ended");
  // A database that passed its checks may still contain invalid values.
  const auto give_up = [&](bool damaged, const std::string& why) {
    store.give_up();
    made = damaged ? fail(ErrorKind::Malformed, "", store.set_aside_as("is damaged: " + why))
                   : fail(ErrorKind::Unwritable, store.folder().at("popcut.db"), why);
  };
  thread.run(ServiceThread::Lane::Asking, [&] {
    try {
      auto service =
          std::make_unique<AssembledService>(store, thread, planner, cutters, std::move(options));
      if (const Answer<void> begun = service->begin(); begun)
        made = std::move(service);
      else if (store.file() == nullptr)  // nothing is wrong with the files on this disk
        made = fail(begun.error().kind == ProblemKind::StateConflict ? ErrorKind::Malformed
                                                                     : ErrorKind::Refused,
                    "fleet", begun.error().detail);
      else
        give_up(begun.error().kind == ProblemKind::Internal, begun.error().detail);
    } catch (const StoreFault& fault) {
      give_up(fault.kind() != FaultKind::Full && fault.kind() != FaultKind::Io, fault.what());
    }
  });
  return made;
}

}  // namespace popcut::daemon
