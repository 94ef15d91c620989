// SPDX-License-Identifier: MIT
#include "daemon/service/live/cut_verdict.hpp"

#include <algorithm>

namespace popcut::daemon {
namespace {

PathFate path_fate(StrokeFate fate) {
  switch (fate) {
    case StrokeFate::NotSent:
      return PathFate::NotSent;
    case StrokeFate::InDoubt:
      return PathFate::InDoubt;
    case StrokeFate::Certain:
      return PathFate::Certain;
  }
  return PathFate::InDoubt;
}

CutVerdict refused(ErrorReason reason, const std::string& text) {
  switch (reason) {
    case ErrorReason::Stalled:
    case ErrorReason::Overflow:
      return {"stall", "device_fault", text};
    case ErrorReason::NoMedia:
      return {"media_out", "media_out", text};
    case ErrorReason::NoMarks:
      return {"marks_not_found", "device_fault", text};
    case ErrorReason::PanelStop:
      return {"panel_stop", "in_doubt", text};
    case ErrorReason::None:
    case ErrorReason::TooMuch:
    case ErrorReason::NotThere:
    case ErrorReason::Misplaced:
    case ErrorReason::Unclear:
      break;
  }
  return {"refused", "device_fault", text};
}

CutVerdict broken(const Error& error) {
  const std::string text = message(error);
  switch (error.kind) {
    case ErrorKind::DeviceGone:
      return {"device_gone", "device_absent", text};
    case ErrorKind::Timeout:
      return {"stall", "device_fault", text};
    case ErrorKind::Unwritable:
      return {"store", "in_doubt", text};
    case ErrorKind::Refused:
      return refused(error.reason, text);
    default:
      return {"error", "device_fault", text};
  }
}

}  // namespace

std::vector<FateRun> fate_runs(const std::vector<StrokeFate>& fates,
                               const std::vector<std::uint32_t>& dots, std::int64_t first,
                               std::int64_t strokes) {
  std::vector<FateRun> runs;
  // `fates` begins with the first stroke of the program, or with stroke `first`.
  const auto given = static_cast<std::int64_t>(fates.size());
  const std::int64_t offset = given == strokes ? 0 : first;
  PathFate before = PathFate::Certain;
  for (std::int64_t stroke = first; stroke < strokes; ++stroke) {
    const std::int64_t at = stroke - offset;
    PathFate fate = PathFate::NotSent;
    if (at < given) fate = path_fate(fates[static_cast<std::size_t>(at)]);
    if (std::binary_search(dots.begin(), dots.end(), static_cast<std::uint32_t>(stroke)))
      fate = before;
    before = fate;
    if (!runs.empty() && runs.back().fate == fate)
      runs.back().paths.last = stroke;
    else
      runs.push_back({{stroke, stroke}, fate});
  }
  return runs;
}

CutVerdict verdict_on(const SessionEnd& end, const std::vector<FateRun>& runs, bool stopping) {
  const auto all = [&](auto holds) { return std::all_of(runs.begin(), runs.end(), holds); };
  const bool certain = all([](const FateRun& run) { return run.fate == PathFate::Certain; });
  const bool sent = all([](const FateRun& run) { return run.fate != PathFate::NotSent; });
  if (end.cancelled)
    return stopping ? CutVerdict{"shutdown", "in_doubt", "popcutd was stopped during the cut"}
                    : CutVerdict{"stopped", "in_doubt", "the cut was stopped"};
  if (end.error) return broken(*end.error);
  CutVerdict verdict{"done", "", ""};
  verdict.complete = certain && end.confirmed;
  if (verdict.complete) return verdict;
  verdict = {"unconfirmed", "confirm_result",
             "everything was sent, but this machine does not report whether it was cut; look at "
             "the sheet and record whether it is good"};
  verdict.unconfirmed = sent;
  if (!sent) verdict = {"error", "in_doubt", "the cut ended before everything was sent"};
  return verdict;
}

}  // namespace popcut::daemon
