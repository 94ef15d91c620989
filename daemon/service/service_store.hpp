// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "daemon/digest/digest.hpp"
#include "daemon/model/json_object.hpp"
#include "daemon/model/metrics.hpp"
#include "daemon/model/problem.hpp"
#include "daemon/service/service_options.hpp"
#include "daemon/store/attempt_table.hpp"
#include "daemon/store/store.hpp"
#include "daemon/store/ulid.hpp"

namespace popcut::daemon {

/// The notice that a node sends to all others when credentials have ended or have another role.
inline constexpr const char* kAccessChanged = ":access";

/// The event of a row "seq, kind, time, job, data".
[[nodiscard]] Event event_of(const Rows& rows);

/// The store as the parts of the service use it: transactions and their effects, events, audit, and
/// what happens when a disk fails.
class ServiceStore {
 public:
  ServiceStore(Store& store, const ServiceOptions& options);

  [[nodiscard]] Database& db() { return store_.database(); }
  [[nodiscard]] StateFolder& folder() { return store_.folder(); }
  [[nodiscard]] TimeMs now() const { return options_.wall_ms(); }
  [[nodiscard]] std::int64_t monotonic() const { return options_.monotonic_ms(); }
  [[nodiscard]] const std::string& invocation() const { return options_.invocation; }
  /// Whether other popcutd share the database.
  [[nodiscard]] bool in_fleet() const { return store_.file() == nullptr; }
  /// The files that all nodes share. Without a fleet, every file is already here.
  [[nodiscard]] SharedFiles& files();
  /// In a fleet: fetches a file into the state folder if it is not there yet.
  ///
  /// @retval Unavailable  the file is large and still being fetched; ask again
  [[nodiscard]] Answer<void> fetch_file(const std::string& name);
  /// Which node of the fleet this is; changed by `NodeLease`.
  [[nodiscard]] const NodeMark& node() const { return node_; }
  [[nodiscard]] NodeMark& node() { return node_; }
  /// Keeps the greatest fence. A fence is a number that grows with each START in a fleet.
  void note_fence(std::int64_t fence) { node_.fence = std::max(node_.fence, fence); }
  [[nodiscard]] std::string new_id() { return new_id(now()); }
  /// A new id with the time `created`. Use the time that the row shows, because lists find a row by
  /// the time in its id.
  [[nodiscard]] std::string new_id(TimeMs created) { return ulids_.next(created); }

  /// Runs `effect`, which returns an Answer, in a transaction. A problem or a fault of the store
  /// rolls it back. On a full disk this frees the reserve and runs `effect` once more. If another
  /// node of a fleet changed the same rows, it runs `effect` a few times more.
  ///
  /// Inside another `change`, `effect` becomes a part of the outer transaction. The outer `change`
  /// then gets a StoreFault.
  template <typename Effect>
  auto change(const Effect& effect) -> decltype(effect()) {
    const bool nested = db().in_transaction();
    if (degraded_) return tl::unexpected(degraded_problem());
    const std::int64_t begun = monotonic();
    for (int tries = 0;; ++tries) {
      const Marks marks = this->marks();
      try {
        Transaction all(db());
        auto answer = effect();
        if (!answer) {
          forget_after(marks);
          return answer;
        }
        if (!nested) store_events();
        all.commit();
        if (!nested) follow_up();
        return answer;
      } catch (const StoreFault& fault) {
        forget_after(marks);
        if (nested) throw;
        handle_fault(fault);
        if (tries == 0 && fault.kind() == FaultKind::Full && folder().free_reserve()) continue;
        // Do not wait again for a row that others hold for seconds: a cutter may need this thread.
        const bool is_early = monotonic() - begun < kMostTrying_ms;
        if (tries < kMostTries && is_early && was_overtaken(fault)) continue;
        return tl::unexpected(problem_of(fault));
      } catch (...) {
        // For example there is no memory. These effects must not follow the next commit.
        forget_after(marks);
        throw;
      }
    }
  }
  /// Runs `reading`, which returns an Answer and changes nothing.
  template <typename Reading>
  auto read(const Reading& reading) -> decltype(reading()) {
    try {
      return reading();
    } catch (const StoreFault& fault) {
      if (db().in_transaction()) throw;
      handle_fault(fault);
      return tl::unexpected(problem_of(fault));
    }
  }
  /// Runs `work` after the commit of the outermost transaction and after its events were published.
  /// After a rollback `work` does not run.
  void after_commit(std::function<void()> work) { after_.push_back(std::move(work)); }
  /// The same, but before the events are published, so that listeners see the effect of `work`.
  void after_commit_before_events(std::function<void()> work) { with_.push_back(std::move(work)); }

  /// Stores an event with the transaction, and publishes it after the commit. `members` follow the
  /// members that all events have.
  void emit(const std::string& kind, const std::string& job, const JsonObject& members);
  /// Calls the listeners now. Does not store the event. Logs what a listener throws.
  void publish(const Event& event);
  /// In a fleet: publishes the stored events of all nodes that were not published here yet.
  void deliver_new_events();
  /// Called for each event of another node, before the listeners.
  std::function<void(const Event&)> on_remote_event{};
  /// Called once after each batch of remote events.
  std::function<void()> after_remote_events{};
  /// The last event that was published here.
  [[nodiscard]] std::int64_t last_delivered() const { return last_delivered_; }
  /// The first call starts after the newest stored event. Later calls continue after the last
  /// published event. If the database lost that event, they start after the newest one.
  void begin_delivery();
  void listen(std::function<void(const Event&)> listener) {
    listeners_.push_back(std::move(listener));
  }
  void audit(const std::string& principal, std::string_view action, const std::string& subject,
             const std::string& detail);
  void log(const std::string& line) const;

  /// Reacts to a fault. On a full disk new work is refused. After a failed write nothing more is
  /// written until popcutd restarts, and all cuts stop at the end of their stroke.
  void handle_fault(const StoreFault& fault);
  void note_full();
  /// Reacts to a file that could not be stored as to a full disk, and returns the problem.
  [[nodiscard]] Problem file_problem(const Error& error);
  /// Whether a write failed. Then nothing more is written until popcutd restarts.
  [[nodiscard]] bool degraded() const { return degraded_; }
  [[nodiscard]] bool full() const { return full_; }
  /// Refuses while no new work is accepted.
  [[nodiscard]] Answer<void> accepts_work() const;
  /// Refuses while no sheet may be armed.
  [[nodiscard]] Answer<void> accepts_arming() const;
  /// Call this when the check of the whole database has ended. If `damage` is empty, sheets may be
  /// armed; otherwise nothing more is written.
  void check_ended(const std::string& damage);
  /// If there is enough disk space, reserves some again and accepts new work again.
  void recover_disk();
  std::function<void()> on_degraded{};
  /// In a fleet: called when the answer to a commit is lost, so that nobody knows whether it
  /// happened.
  std::function<void()> on_doubt{};

  [[nodiscard]] Problem problem_of(const StoreFault& fault) const;

  struct Figures {
    Histogram commits{{0.001, 0.003, 0.01, 0.03, 0.1, 1}};
    /// How long a cutter gets no data while the intent of its next strokes is being written.
    Histogram stream_waits{{0.001, 0.003, 0.01, 0.03, 0.1, 1}};
  };
  [[nodiscard]] const Figures& figures() const { return figures_; }
  void note_stream_wait(double seconds) { figures_.stream_waits.add(seconds); }

 private:
  struct Marks {
    std::size_t after, with, events;
  };
  [[nodiscard]] Marks marks() const { return {after_.size(), with_.size(), events_.size()}; }
  void forget_after(const Marks& marks);
  static constexpr int kMostTries = 5;
  static constexpr std::int64_t kMostTrying_ms = 1000;
  [[nodiscard]] bool was_overtaken(const StoreFault& fault) const;
  void store_events();
  /// Logs what `work` throws.
  void try_to(const std::function<void()>& work) const;
  void number_events();
  void follow_up();
  void degrade(const std::string& why);
  [[nodiscard]] Problem degraded_problem() const;
  [[nodiscard]] std::string moved_away() const;

  Store& store_;
  const ServiceOptions& options_;
  UlidSource ulids_;
  std::vector<std::function<void()>> after_, with_;
  std::vector<Event> events_;  ///< of this transaction; a fleet numbers them after the commit
  NodeMark node_;
  std::int64_t last_delivered_{0};  ///< in a fleet: the last event that was published here
  bool is_delivering_{false}, has_delivered_{false};
  /// In a fleet: stored events of this node that are not published yet, without their numbers.
  std::multiset<std::string> own_{};
  std::vector<std::function<void(const Event&)>> listeners_;
  std::string degraded_why_;
  bool degraded_{false};
  bool full_{false};
  Figures figures_;
};

}  // namespace popcut::daemon
