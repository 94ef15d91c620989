// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <type_traits>

#include <unistd.h>

#include "daemon/service/live/live_service.hpp"
#include "tests/support/fake_cutters.hpp"
#include "tests/support/fake_planner.hpp"
#include "tests/support/process.hpp"

namespace popcut::testing {

inline void write_text(const std::string& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

/// A service with a store in a scratch folder and fakes for planner and cutters.
class ServiceBench {
  mutable std::optional<TempFolder> scratch_;
  std::vector<std::unique_ptr<daemon::ServiceThread>> buried_;

 public:
  const daemon::Principal viewer{"uid:1", daemon::Role::Viewer};
  const daemon::Principal student{"uid:2", daemon::Role::Submitter};
  const daemon::Principal other_student{"uid:3", daemon::Role::Submitter};
  const daemon::Principal tutor{"uid:4", daemon::Role::Operator};
  const daemon::Principal admin{"uid:5", daemon::Role::Admin};
  const std::string device{"sim:cameo3"};

  /// Set by a test program whose benches are nodes of a fleet: a connection to the database that
  /// `kept` names, which it makes and names if it is empty.
  static inline std::function<std::unique_ptr<daemon::Database>(std::shared_ptr<void>& kept)>
      shared_database{};

  /// What follows the number of a user of the unix socket.
  [[nodiscard]] static std::string machine() { return shared_database ? "@bench" : ""; }

  /// Of this bench, a node of a fleet: makes its connection.
  std::function<std::unique_ptr<daemon::Database>()> database{};
  std::function<void(daemon::Store&)> opened_store{};

  daemon::ServiceOptions options;
  std::string place;        ///< its state folder; empty: one of its own, that goes with it
  bool check_later{false};  ///< all of the database: nothing is armed until `check_ended` is called
  std::string vfs;
  std::uint64_t reserve_bytes{1u << 16};
  std::int64_t skew_ms{0};            ///< of the wall's clock
  std::int64_t monotonic_skew_ms{0};  ///< of the other one
  FakePlanner planner;
  FakeCutters cutters;

  explicit ServiceBench(bool begin = true) : ServiceBench(std::vector<std::string>{}, begin) {}
  explicit ServiceBench(std::vector<std::string> devices, bool begin = true)
      : cutters(devices.empty() ? std::vector<std::string>{"sim:cameo3"} : devices) {
    options.read_program = read_fake_program;
    options.least_free_bytes = 1;
    options.wall_ms = [this] {
      using namespace std::chrono;
      return duration_cast<milliseconds>(system_clock::now().time_since_epoch()).count() + skew_ms;
    };
    options.monotonic_ms = [this] {
      using namespace std::chrono;
      return duration_cast<milliseconds>(steady_clock::now().time_since_epoch()).count() +
             monotonic_skew_ms;
    };
    if (begin) start();
  }
  ~ServiceBench() { stop(); }

  /// Opens the store and the service; the error as text, or nothing.
  std::string start() {
    if (shared_database && !database) {
      options.fleet.node = "bench";
      options.fleet.mark_s = 0;
      options.fleet.has_database_clock = false;  // cases put the other one forward and back
    }
    const auto connect = [&] { return database ? database() : shared_database(database_); };
    auto opened =
        database || shared_database
            ? daemon::Store::over({.folder = folder(), .reserve_bytes = reserve_bytes}, connect())
            : daemon::Store::open({.folder = folder(),
                                   .reserve_bytes = reserve_bytes,
                                   .vfs = vfs,
                                   .check_later = check_later});
    if (!opened) return message(opened.error());
    store_ = std::move(*opened);
    if (opened_store) opened_store(*store_);
    thread_ = std::make_unique<daemon::ServiceThread>();
    auto made = daemon::make_service(*store_, *thread_, planner, cutters, options);
    if (!made) return made.error().detail;
    service_ = std::move(*made);
    return {};
  }
  /// Ends in order.
  void stop() {
    if (thread_) thread_->stop();
    service_.reset();
    join_thread();
    planner.forget();
    store_.reset();
  }
  /// Ends as a killed process does: nothing is moved, flushed or marked.
  void crash() {
    thread_->stop();
    service_.reset();
    join_thread();
    planner.forget();
    store_->give_up();
    store_.reset();
    cutters.forget();
  }

  [[nodiscard]] std::string folder() const {
    if (!place.empty()) return place;
    if (!scratch_) scratch_.emplace(TempFolder::Place::Memory);
    return (*scratch_ / "state").string();
  }
  [[nodiscard]] daemon::Store& store() { return *store_; }
  [[nodiscard]] daemon::ServiceThread& thread() { return *thread_; }
  [[nodiscard]] daemon::LiveService& service() { return *service_; }

  /// `work(service)` on the service's thread.
  template <typename Work>
  auto on(const Work& work) {
    using Value = std::invoke_result_t<Work, daemon::LiveService&>;
    if constexpr (std::is_void_v<Value>) {
      thread_->run(daemon::ServiceThread::Lane::Asking, [&] { work(*service_); });
    } else {
      std::optional<Value> value;
      thread_->run(daemon::ServiceThread::Lane::Asking, [&] { value.emplace(work(*service_)); });
      return std::move(*value);
    }
  }
  /// Begins something by `start(service, done)` on the service's thread, and waits for what `done`
  /// is told.
  template <typename Value, typename Start>
  daemon::Answer<Value> told(const Start& start) {
    struct State {
      std::mutex mutex;
      std::condition_variable over;
      std::optional<daemon::Answer<Value>> answer;
    };
    auto state = std::make_shared<State>();
    on([&](daemon::LiveService& service) {
      start(service, [state](daemon::Answer<Value> answer) {
        const std::lock_guard lock(state->mutex);
        state->answer.emplace(std::move(answer));
        state->over.notify_all();
      });
    });
    std::unique_lock lock(state->mutex);
    state->over.wait_for(lock, std::chrono::seconds(60), [&] { return state->answer.has_value(); });
    if (!state->answer) return daemon::refuse(daemon::ProblemKind::Internal, "no answer");
    return std::move(*state->answer);
  }
  daemon::Answer<std::string> backup(const daemon::Principal& who) {
    return told<std::string>(
        [&](daemon::LiveService& s, auto done) { s.operations.backup(who, done); });
  }
  daemon::Answer<std::string> check_integrity() {
    return told<std::string>(
        [&](daemon::LiveService& s, auto done) { s.operations.check_integrity(admin, done); });
  }
  std::vector<daemon::UsageRow> usage(const std::string& by,
                                      std::optional<daemon::TimeMs> from = {},
                                      std::optional<daemon::TimeMs> to = {}) {
    return told<std::vector<daemon::UsageRow>>(
               [&](daemon::LiveService& s, auto done) { s.operations.usage(from, to, by, done); })
        .value();
  }
  /// Waits until `holds()`; false after a minute.
  bool wait(const std::function<bool()>& holds) {
    for (int i = 0; i < 60'000; ++i) {
      if (holds()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return false;
  }

  /// Uploads a design of that text; gives its id or the problem.
  daemon::Answer<daemon::Design> add_design(const std::string& text,
                                            const std::string& name = "card") {
    static std::atomic<int> number{0};
    const std::string path = folder() + "/incoming/upload-" + std::to_string(++number);
    write_text(path, text);
    std::mutex mutex;
    std::condition_variable over;
    std::optional<daemon::Answer<daemon::Design>> answer;
    on([&](daemon::LiveService& service) {
      service.designs.add(student, {path, daemon::sha256_hex(text), text.size()},
                          "application/json", name, [&](daemon::Answer<daemon::Design> done) {
                            const std::lock_guard lock(mutex);
                            answer.emplace(std::move(done));
                            over.notify_all();
                          });
    });
    std::unique_lock lock(mutex);
    over.wait_for(lock, std::chrono::seconds(60), [&] { return answer.has_value(); });
    return answer ? *answer : daemon::refuse(daemon::ProblemKind::Internal, "no answer");
  }
  daemon::Answer<daemon::Job> create(const std::string& design, int copies = 1) {
    daemon::JobCreate request;
    request.design = design;
    request.copies = copies;
    return on([&](daemon::LiveService& service) { return service.jobs.create(student, request); });
  }
  daemon::Job job(const std::string& id) {
    return on([&](daemon::LiveService& service) { return service.jobs.find(id).value(); });
  }
  daemon::Job wait_for(const std::string& id, daemon::JobState state) {
    wait([&] { return job(id).state == state; });
    return job(id);
  }
  /// A job that is ready for its first sheet.
  daemon::Job ready_job(const std::string& text = "{\"card\":1}", int copies = 1) {
    const auto design = add_design(text);
    const auto made = create(design.value().id, copies);
    return wait_for(made.value().id, daemon::JobState::Ready);
  }
  daemon::Answer<daemon::Job> act(const std::string& id, daemon::ActionRequest request) {
    return on([&](daemon::LiveService& service) {
      const auto now = service.jobs.find(id);
      if (!now) return now;
      if (!request.sheet && request.action != daemon::JobAction::Start) request.sheet = now->sheet;
      return service.cutting.act(tutor, id, now->rev, request);
    });
  }
  daemon::Answer<daemon::Job> act(const std::string& id, daemon::JobAction action) {
    return act(id, daemon::ActionRequest{.action = action});
  }
  /// Armed and started: the sheet is with the cutter.
  daemon::Job started(const std::string& id) {
    act(id, daemon::JobAction::Arm).value();
    return act(id, daemon::JobAction::Start).value();
  }

 private:
  std::shared_ptr<void> database_{};
  // The planner outlives it and may still want to tell it something.
  void join_thread() {
    if (thread_) buried_.push_back(std::move(thread_));
  }
  std::unique_ptr<daemon::Store> store_;
  std::unique_ptr<daemon::ServiceThread> thread_;
  std::unique_ptr<daemon::LiveService> service_;
};

/// The job as it is now.
inline daemon::Job shown(ServiceBench& bench, const daemon::Job& job) { return bench.job(job.id); }

inline std::string sheet_state(ServiceBench& bench, const std::string& job, std::size_t sheet = 1) {
  return bench.on([&](daemon::LiveService& service) {
    return service.jobs.sheets(job).value().at(sheet - 1).state;
  });
}

inline daemon::Ledger ledger(ServiceBench& bench, const std::string& job, int sheet = 1) {
  return bench.on(
      [&](daemon::LiveService& service) { return service.jobs.ledger(job, sheet).value(); });
}

/// Interrupted with strokes 0..1 certain and 2 in doubt, of 5.
inline daemon::Job broken(ServiceBench& bench, ErrorKind kind = ErrorKind::DeviceGone,
                          const std::string& words = "unplugged",
                          ErrorReason reason = ErrorReason::None) {
  const daemon::Job ready = bench.ready_job();
  bench.started(ready.id);
  if (!bench.cutters.intend(bench.device, 2)) throw std::runtime_error("nothing is being cut");
  bench.cutters.finish(bench.device,
                       {.error = Error{kind, "", words, reason}, .certain = 1, .doubt = 2});
  return bench.job(ready.id);
}

}  // namespace popcut::testing
