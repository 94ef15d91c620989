// SPDX-License-Identifier: MIT
#include "daemon/jobs/resume.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace popcut::daemon {
namespace {

// Runs of equal fate become one.
void append(std::vector<FateRun>& runs, PathRange paths, PathFate fate) {
  if (paths.last < paths.first) return;
  if (!runs.empty() && runs.back().fate == fate)
    runs.back().paths.last = paths.last;
  else
    runs.push_back({paths, fate});
}

// Lays `top` over `base`; both cover parts of the same strokes, `base` all of them.
std::vector<FateRun> laid_over(const std::vector<FateRun>& base, const FateRun& top) {
  std::vector<FateRun> runs;
  for (const FateRun& below : base) {
    const PathRange shared{std::max(below.paths.first, top.paths.first),
                           std::min(below.paths.last, top.paths.last)};
    if (shared.last < shared.first || below.fate == PathFate::Certain) {
      append(runs, below.paths, below.fate);
      continue;
    }
    append(runs, {below.paths.first, shared.first - 1}, below.fate);
    append(runs, shared, top.fate);
    append(runs, {shared.last + 1, below.paths.last}, below.fate);
  }
  return runs;
}

}  // namespace

std::vector<FateRun> merged_fates(std::int64_t strokes,
                                  const std::vector<std::vector<FateRun>>& attempts) {
  std::vector<FateRun> runs;
  append(runs, {0, strokes - 1}, PathFate::NotSent);
  for (const std::vector<FateRun>& attempt : attempts)
    for (const FateRun& run : attempt)
      if (run.fate != PathFate::NotSent) runs = laid_over(runs, run);
  return runs;
}

void fill_ledger(Ledger& ledger, const std::vector<FateRun>& runs) {
  ledger.certain_upto = -1;
  for (const FateRun& run : runs) {
    if (run.fate == PathFate::Certain) {
      if (run.paths.first == 0) ledger.certain_upto = run.paths.last;
      ledger.certain.push_back(run.paths);
    } else if (run.fate == PathFate::InDoubt) {
      ledger.in_doubt.push_back(run.paths);
    } else {
      ledger.not_sent.push_back(run.paths);
    }
  }
}

tl::expected<void, std::string> may_resume(const std::vector<FateRun>& runs,
                                           const ResumeRequest& request, const ResumeFacts& facts) {
  const auto no = [](std::string why) { return tl::unexpected<std::string>(std::move(why)); };
  const std::int64_t from = request.from_path;
  if (from < 0 || from >= facts.strokes)
    return no(fmt::format("path {} is not on this sheet; must be 0..{}", from, facts.strokes - 1));
  if (!request.re_registered && !facts.same_device_session)
    return no(
        "the cutter was disconnected or restarted, so the sheet's position is unknown; align the "
        "sheet again and use registration \"re-registered\"");
  for (const FateRun& run : runs) {
    const bool reaches = run.paths.last >= from;  // some of it would be cut now
    const bool before = run.paths.first < from;   // some of it would not
    const std::string where = fmt::format("paths {}..{}", run.paths.first, run.paths.last);
    if (run.fate == PathFate::InDoubt && reaches && before)
      return no(where + " are in doubt; resume from the first of them, or after the last");
    if (run.fate == PathFate::InDoubt && before && !request.skip_in_doubt)
      return no(where + " are in doubt and would stay so; use skip_in_doubt, or resume from " +
                std::to_string(run.paths.first));
    if (run.fate == PathFate::NotSent && before)
      return no(fmt::format("{} were not cut and would be skipped; resume from {} or earlier",
                            where, run.paths.first));
    if (run.fate != PathFate::NotSent && reaches && !request.accept_double_cut)
      return no(
          fmt::format("{} {} and would be cut twice; use i_accept_double_cut, or use a new blank "
                      "with retry-sheet",
                      where, run.fate == PathFate::Certain ? "are cut" : "may be cut already"));
  }
  return {};
}

}  // namespace popcut::daemon
