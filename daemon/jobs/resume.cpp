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
  const std::int64_t from = request.from_path;
  std::vector<std::string> reasons;
  if (from < 0 || from >= facts.strokes)
    reasons.push_back(
        fmt::format("path {} is not on this sheet; must be 0..{}", from, facts.strokes - 1));
  if (!request.re_registered && !facts.same_device_session)
    reasons.emplace_back(
        "the cutter was disconnected or restarted, so the sheet's position is unknown; align the "
        "sheet again and use registration \"re-registered\"");
  for (const FateRun& run : runs) {
    if (from < 0 || from >= facts.strokes) break;
    const bool reaches = run.paths.last >= from;  // some of it would be cut now
    const bool before = run.paths.first < from;   // some of it would not
    const std::string where = fmt::format("paths {}..{}", run.paths.first, run.paths.last);
    if (run.fate == PathFate::InDoubt && reaches && before)
      reasons.push_back(where + " are in doubt; resume from the first of them, or after the last");
    else if (run.fate == PathFate::InDoubt && before && !request.skip_in_doubt)
      reasons.push_back(where +
                        " are in doubt and would stay so; use skip_in_doubt, or resume from " +
                        std::to_string(run.paths.first));
    else if (run.fate == PathFate::NotSent && before)
      reasons.push_back(
          fmt::format("{} were not cut and would be skipped; resume from {} or earlier", where,
                      run.paths.first));
    else if (run.fate != PathFate::NotSent && reaches && !request.accept_double_cut)
      reasons.push_back(
          fmt::format("{} {} and would be cut twice; use i_accept_double_cut, or use a new blank "
                      "with retry-sheet",
                      where, run.fate == PathFate::Certain ? "are cut" : "may be cut already"));
  }
  if (reasons.empty()) return {};
  return tl::unexpected<std::string>(fmt::format("{}", fmt::join(reasons, "; ")));
}

std::vector<ResumeRequest> possible_resumes(const std::vector<FateRun>& runs,
                                            const ResumeRequest& wanted, const ResumeFacts& facts) {
  constexpr std::size_t kMost = 3;
  std::vector<std::int64_t> starts{wanted.from_path};
  for (const FateRun& run : runs) {
    if (run.fate == PathFate::InDoubt) starts.push_back(run.paths.last + 1);
    if (run.fate == PathFate::NotSent) starts.push_back(run.paths.first);
  }
  for (const FateRun& run : runs)
    if (run.fate == PathFate::InDoubt) starts.push_back(run.paths.first);
  std::vector<ResumeRequest> resumes;
  // What the person wanted first, then what cuts nothing twice.
  for (const bool twice : {false, true})
    for (const std::int64_t from : starts) {
      ResumeRequest resume{.from_path = from,
                           .re_registered = wanted.re_registered || !facts.same_device_session};
      for (const FateRun& run : runs) {
        if (run.fate == PathFate::InDoubt && run.paths.last < from) resume.skip_in_doubt = true;
        if (run.fate != PathFate::NotSent && run.paths.last >= from)
          resume.accept_double_cut = true;
      }
      const bool known = std::any_of(resumes.begin(), resumes.end(), [&](const ResumeRequest& one) {
        return one.from_path == from;
      });
      const bool now = resume.accept_double_cut == twice || from == wanted.from_path;
      if (resumes.size() < kMost && !known && now && may_resume(runs, resume, facts))
        resumes.push_back(resume);
    }
  return resumes;
}

}  // namespace popcut::daemon
