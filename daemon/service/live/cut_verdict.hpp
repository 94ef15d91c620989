// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "daemon/jobs/resume.hpp"
#include "device/session/session.hpp"

namespace popcut::daemon {

/// What the end of a session means for the job.
struct CutVerdict {
  std::string kind;         ///< "done", "device_gone", "panel_stop", ...
  std::string attention;    ///< kind of the attention that an interrupted job gets
  std::string text;         ///< for people
  bool complete{false};     ///< all strokes are certain, and the device reported that it is idle
  bool unconfirmed{false};  ///< all was sent, but the device did not report that it was cut
};
/// @param runs  the fates of the strokes that were to be cut, from `fate_runs`
[[nodiscard]] CutVerdict verdict_on(const SessionEnd& end, const std::vector<FateRun>& runs,
                                    bool stopping);
/// The fates of strokes `first ..` as runs. Dots, which are never sent, share the fate of the
/// stroke before them.
[[nodiscard]] std::vector<FateRun> fate_runs(const std::vector<StrokeFate>& fates,
                                             const std::vector<std::uint32_t>& dots,
                                             std::int64_t first, std::int64_t strokes);

}  // namespace popcut::daemon
