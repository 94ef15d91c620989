// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "daemon/service/cut_desk.hpp"

namespace popcut::daemon {

/// A cut that is under way, or whose end is not written yet.
struct CutDesk::Cut {
  std::string job, owner, attempt, device, material, operator_name;
  int sheet{}, blank{};
  std::int64_t first{0}, strokes{0};
  SheetPlan plan;
  std::vector<std::uint32_t> dots;
  CutOrder order;  ///< until it is handed over

  // On the service's thread.
  AttemptMarks marks;
  LiveCut live;
  bool cancel_asked{false}, over{false};
  std::optional<std::string> refusal;  ///< why the cutter did not take it
  std::string shown;                   ///< kind of the attention that is shown meanwhile
  SessionPhase phase{SessionPhase::Connecting};
  std::int64_t told_ms{-1'000'000};

  // Left by the cutter's thread.
  std::mutex mutex;
  std::int64_t settled_certain{-1}, settled_taken{-1};
  std::uint64_t settled_bytes{};
  bool settled{false};
  std::optional<SessionProgress> progress;
};

/// What a session's end means, in words that are stored.
struct CutVerdict {
  std::string kind;         ///< "done", "device_gone", "panel_stop", ...
  std::string attention;    ///< kind of the attention that an interrupted job gets
  std::string text;         ///< for people
  bool complete{false};     ///< all certain, and the device said that it rests
  bool unconfirmed{false};  ///< all sent, nobody said anything
};
/// `runs` are the fates of the strokes that were to be cut, dots aside.
[[nodiscard]] CutVerdict verdict_on(const SessionEnd& end, const std::vector<FateRun>& runs,
                                    bool stopping);
/// The fates of strokes `first ..` as runs. Dots, which are never sent, share the fate of the
/// stroke before them.
[[nodiscard]] std::vector<FateRun> fate_runs(const std::vector<StrokeFate>& fates,
                                             const std::vector<std::uint32_t>& dots,
                                             std::int64_t first, std::int64_t strokes);

}  // namespace popcut::daemon
