// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "daemon/service/live/cut_dispatcher.hpp"

namespace popcut::daemon {

/// A running cut, or one whose end is not recorded yet.
struct CutDispatcher::Cut {
  std::string job, owner, attempt, device, material, operator_name;
  int sheet{}, blank{};
  std::int64_t first{0}, strokes{0};
  SheetPlan plan;
  std::vector<std::uint32_t> dots;
  CutOrder order;                          ///< until it is handed over
  std::unique_ptr<IntentJournal> intents;  ///< of the cutter's thread, once it is handed over

  // On the service's thread.
  AttemptMarks marks;
  LiveCut live;
  bool cancel_asked{false}, over{false};
  bool pause_asked{false};             ///< by who could not write it down
  bool superseded{false};              ///< in a fleet: a person decided otherwise while it was lost
  std::int64_t marked_ms{-1'000'000};  ///< when its marks were last stored
  bool unmarked{false};                ///< in a fleet: the database does not have the last ones yet
  std::optional<std::string> refusal;  ///< why the cutter did not take it
  std::string shown;                   ///< kind of the attention that is shown meanwhile
  SessionPhase phase{SessionPhase::Connecting};
  std::int64_t told_ms{-1'000'000};
  SessionProgress told{};  ///< what was last told of

  // Left by the cutter's thread.
  std::mutex mutex;
  std::int64_t settled_certain{-1}, settled_taken{-1};
  std::uint64_t settled_bytes{};
  bool settled{false};
  std::optional<SessionProgress> progress;

  [[nodiscard]] std::uint64_t bytes_taken() {
    const std::lock_guard lock(mutex);
    return settled_bytes;
  }
};

}  // namespace popcut::daemon
