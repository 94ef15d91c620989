// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "daemon/service/repositories/job_repository.hpp"
#include "daemon/store/intent_journal.hpp"
#include "device/session/session.hpp"

namespace popcut::daemon {

// What this run of popcutd knows about jobs and cuts and does not store in the database. Each state
// has exactly the data that is valid in it:
//
//   Waiting --arm--> Armed --START--> InDoubt --committed--> Running --session over--> Ended
//
// A disarmed job is `Waiting` again. An attempt in doubt whose answer is lost is revoked. A cut
// that the cutter refuses goes from `Running` to `Refused`. `Refused` and `Ended` are forgotten
// when they are recorded.
//
// `Waiting` and `Armed` are states of a job that is not cut. The others are states of an attempt,
// which begins with a START.

/// The part of a sheet with which a cut begins.
struct CutStart {
  int segment{1};
  std::int64_t first_stroke{};
  friend bool operator==(const CutStart&, const CutStart&) = default;
};

/// Nothing is armed at this node.
struct Waiting {
  /// The session of the cutter in which the sheet was registered; empty: nobody knows its place.
  std::string placed_in{};
  /// Where a person last asked to resume the sheet.
  std::optional<CutStart> resume_at{};
};

/// A person armed the sheet at this node. START may follow until `until_ms`.
struct Armed {
  std::int64_t until_ms{};  ///< monotonic
  CutStart start{};         ///< what was armed; START is refused if the job has another one by then
  Waiting waiting{};        ///< the state to return to when the sheet is no longer armed
};

/// What is known of the next cut of a job.
using NextCut = std::variant<Waiting, Armed>;

/// The data of `Waiting`, which an armed job has, too.
[[nodiscard]] inline const Waiting& waiting_of(const NextCut& next) {
  const Armed* const armed = std::get_if<Armed>(&next);
  return armed != nullptr ? armed->waiting : std::get<Waiting>(next);
}
[[nodiscard]] inline Waiting& waiting_of(NextCut& next) {
  return const_cast<Waiting&>(waiting_of(std::as_const(next)));
}

/// An attempt, from its START on. One object for all its states.
struct Cut {
  AttemptRow attempt;  ///< as it was stored
  std::string owner;   ///< of the job
  double length_mm{};  ///< of all cuts and folds of the sheet
  std::vector<std::uint32_t> dots;
  /// Once the cutter has the sheet, only its thread uses this.
  std::unique_ptr<IntentJournal> intents;

  // On the service's thread.
  AttemptMarks marks;                  ///< the strokes that are recorded
  LiveCut live;                        ///< what the job shows while the sheet is cut
  std::int64_t marked_ms{-1'000'000};  ///< in a fleet: when `marks` was last stored in the database
  bool is_unmarked{false};             ///< in a fleet: the database has older marks

  // Written by the cutter's thread, under the lock.
  struct Settled {
    std::int64_t certain{-1};  ///< the last stroke that is certainly cut
    std::int64_t taken{-1};    ///< the last stroke of which the cutter accepted a byte
    std::uint64_t bytes{};     ///< that the cutter accepted
    bool is_new{false};        ///< it is not recorded yet
  };
  std::mutex mutex;
  Settled settled;
  std::optional<SessionProgress> news;  ///< progress that the service's thread has not seen yet

  [[nodiscard]] std::uint64_t bytes_taken() {
    const std::lock_guard lock(mutex);
    return settled.bytes;
  }
};

/// The database was asked to store the START and has not confirmed it. The knife has not moved. If
/// the answer is lost, the START is revoked once the database can be asked again.
struct InDoubt {};

/// The cutter has the sheet.
struct Running {
  std::shared_ptr<Cut> cut;
  bool is_pause_unrecorded{false};        ///< a pause could not be stored yet
  bool is_cancelled{false};               ///< a person cancelled it
  SessionProgress progress{};             ///< the last one
  std::string attention{};                ///< kind of the attention that the job shows now
  std::int64_t published_ms{-1'000'000};  ///< when progress was last published

  /// Whether the tool is up and waits.
  [[nodiscard]] bool is_held() const { return progress.phase == SessionPhase::Held; }
};

/// The cutter refused the sheet, so no byte was sent. The database does not say so yet.
struct Refused {
  std::shared_ptr<Cut> cut;
  std::string why;
};

/// The session has ended. The database does not say so yet.
struct Ended {
  std::shared_ptr<Cut> cut;
  SessionEnd end;
  bool is_cancelled{false};  ///< a person cancelled it
  bool was_held{false};      ///< the tool was up, because of a pause
  std::string logged{};      ///< the last logged reason why the end could not be recorded
};

using CutState = std::variant<InDoubt, Running, Refused, Ended>;

[[nodiscard]] inline Refused to_refused(const Running& running, std::string why) {
  return {running.cut, std::move(why)};
}
[[nodiscard]] inline Ended to_ended(const Running& running, SessionEnd end) {
  return {.cut = running.cut,
          .end = std::move(end),
          .is_cancelled = running.is_cancelled,
          .was_held = running.is_held()};
}

/// The attempt in this state; nullptr while it is in doubt.
[[nodiscard]] inline Cut* cut_of(const CutState& state) {
  struct {
    Cut* operator()(const InDoubt&) const { return nullptr; }
    Cut* operator()(const Running& one) const { return one.cut.get(); }
    Cut* operator()(const Refused& one) const { return one.cut.get(); }
    Cut* operator()(const Ended& one) const { return one.cut.get(); }
  } constexpr kCut;
  return std::visit(kCut, state);
}

}  // namespace popcut::daemon
