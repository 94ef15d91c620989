// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "daemon/digest/digest.hpp"
#include "daemon/model/metrics.hpp"
#include "daemon/model/problem.hpp"
#include "daemon/service/service_options.hpp"
#include "daemon/store/attempt_table.hpp"
#include "daemon/store/store.hpp"
#include "daemon/store/ulid.hpp"

namespace popcut::daemon {

/// What nodes of a fleet tell each other when credentials have ended or have another role.
inline constexpr const char* kAccessChanged = ":access";

/// The store as the parts of the service use it: transactions with what follows from them, events,
/// audit, and what a failing disk means.
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
  /// The files that all of them need. Without a fleet nothing is shared, and every file is here.
  [[nodiscard]] SharedFiles& files();
  /// Makes a file be in the state folder if another node has it.
  ///
  /// @retval Unavailable  it is large and on its way: ask again
  [[nodiscard]] Answer<void> bring(const std::string& name);
  /// Who this is among them; changed by `NodeLease`.
  [[nodiscard]] const NodeMark& node() const { return node_; }
  [[nodiscard]] NodeMark& node() { return node_; }
  /// Takes note of the fence of a START.
  void fenced(std::int64_t fence) { node_.fence = std::max(node_.fence, fence); }
  [[nodiscard]] std::string new_id() { return new_id(now()); }
  /// For a row that was made at `created`: lists look for it by the time in its id.
  [[nodiscard]] std::string new_id(TimeMs created) { return ulids_.next(created); }

  /// Runs `effect`, which gives an Answer, in a transaction. A problem, or a fault of the store,
  /// undoes it all. On a full disk the reserve is given up and it runs once more; and a few times
  /// if another node of a fleet changed the same.
  ///
  /// Inside another one it is a part of that, and a fault goes up to it.
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
        note(fault);
        if (tries == 0 && fault.kind() == FaultKind::Full && folder().free_reserve()) continue;
        // A row that others hold for seconds is not waited for again: a cutter may need this
        // thread.
        const bool is_early = monotonic() - begun < kMostTrying_ms;
        if (tries < kMostTries && is_early && was_overtaken(fault)) continue;
        return tl::unexpected(problem_of(fault));
      } catch (...) {
        // Out of memory, say: what would have followed must not follow the next commit.
        forget_after(marks);
        throw;
      }
    }
  }
  /// Runs `look`, which gives an Answer and changes nothing.
  template <typename Look>
  auto look(const Look& look) -> decltype(look()) {
    try {
      return look();
    } catch (const StoreFault& fault) {
      if (db().in_transaction()) throw;
      note(fault);
      return tl::unexpected(problem_of(fault));
    }
  }
  /// Runs `work` once the transaction is committed; never if it is undone.
  void after_commit(std::function<void()> work) { after_.push_back(std::move(work)); }

  /// Stores an event, in a transaction. `members` are JSON members after those that all have:
  /// `"state":"ready","rev":3`.
  void emit(const std::string& kind, const std::string& job, const std::string& members);
  /// Calls the listeners at once; nothing is stored.
  void publish(const Event& event);
  /// In a fleet: tells of the events that are stored and were not told of yet, whoever caused them.
  void deliver_new_events();
  /// Called too for those that other nodes caused.
  std::function<void(const Event&)> on_remote_event{};
  /// After some of them, once for all.
  std::function<void()> after_remote_events{};
  /// The last event that was told of.
  [[nodiscard]] std::int64_t last_delivered() const { return last_delivered_; }
  /// The events from now on are news; after that, those since the last that was told of, unless the
  /// database is an earlier one.
  void begin_delivery();
  void listen(std::function<void(const Event&)> listener) {
    listeners_.push_back(std::move(listener));
  }
  void audit(const std::string& principal, std::string_view action, const std::string& subject,
             const std::string& detail);
  void log(const std::string& line) const;

  /// Takes note of what went wrong: a full disk, or one that fails.
  void note(const StoreFault& fault);
  void note_full();
  /// Takes note that a file could not be kept, and says why.
  [[nodiscard]] Problem unkept(const Error& error);
  /// After a failed write nothing more is written until popcutd restarts.
  [[nodiscard]] bool degraded() const { return degraded_; }
  [[nodiscard]] bool full() const { return full_; }
  /// Why no new work is taken; none: it is.
  [[nodiscard]] Answer<void> accepts_work() const;
  /// Why no knife may be armed yet; none: it may.
  [[nodiscard]] Answer<void> accepts_arming() const;
  /// The outcome of the check of all of the database; empty: it is sound.
  void checked(const std::string& damage);
  /// Takes the reserve again when there is room.
  void recover_disk();
  std::function<void()> on_degraded{};
  /// In a fleet: what was asked of the database last may have been done, or not.
  std::function<void()> on_doubt{};

  [[nodiscard]] Problem problem_of(const StoreFault& fault) const;

  struct Figures {
    Histogram commits{{0.001, 0.003, 0.01, 0.03, 0.1, 1}};
    /// Of a cutter's stream, until what it intends is on the disk.
    Histogram stream_waits{{0.001, 0.003, 0.01, 0.03, 0.1, 1}};
  };
  [[nodiscard]] const Figures& figures() const { return figures_; }
  void note_stream_wait(double seconds) { figures_.stream_waits.add(seconds); }

 private:
  struct Marks {
    std::size_t after, events;
  };
  [[nodiscard]] Marks marks() const { return {after_.size(), events_.size()}; }
  void forget_after(const Marks& marks);
  static constexpr int kMostTries = 5;
  static constexpr std::int64_t kMostTrying_ms = 1000;
  [[nodiscard]] bool was_overtaken(const StoreFault& fault) const;
  void store_events();
  void number_events();
  void follow_up();
  void degrade(const std::string& why);
  [[nodiscard]] Problem degraded_problem() const;
  [[nodiscard]] std::string moved_away() const;

  Store& store_;
  const ServiceOptions& options_;
  UlidSource ulids_;
  std::vector<std::function<void()>> after_;
  std::vector<Event> events_;  ///< of this transaction; in a fleet numbered after its commit
  NodeMark node_;
  std::int64_t last_delivered_{0};  ///< in a fleet: the last event that was told of
  bool is_delivering_{false}, has_delivered_{false};
  /// What events of this node say after their number that were not told of yet.
  std::multiset<std::string> own_{};
  std::vector<std::function<void(const Event&)>> listeners_;
  std::string degraded_why_;
  bool degraded_{false};
  bool full_{false};
  Figures figures_;
};

/// `text` as a JSON string with its quotes.
[[nodiscard]] std::string json_text(std::string_view text);

}  // namespace popcut::daemon
