// SPDX-License-Identifier: MIT
// Part of daemon/service/live/cut_dispatcher.hpp: complete requests that pass now, so that nobody
// is refused twice for what was known the first time.
#include <algorithm>

#include <fmt/format.h>

#include "daemon/model/warnings.hpp"
#include "daemon/service/live/cut_dispatcher.hpp"

namespace popcut::daemon {
namespace {

Way resume_way(const ResumeRequest& one) {
  std::string body = fmt::format(R"({{"from_path":{},"registration":"{}")", one.from_path,
                                 one.re_registered ? "re-registered" : "kept");
  if (one.skip_in_doubt) body += R"(,"skip_in_doubt":true)";
  if (one.accept_double_cut) body += R"(,"i_accept_double_cut":true)";
  return {"resume-from", body + "}"};
}

}  // namespace

std::string CutDispatcher::accepting(const JobRow& row) {
  if (row.unaccepted.empty()) return {};
  std::string codes;
  for (const std::string& code : codes_of(row.unaccepted))
    codes += fmt::format(R"({}"{}")", codes.empty() ? "" : ",", code);
  return fmt::format(R"(,"accept_warnings":[{}])", codes);
}

std::optional<ResumeState> CutDispatcher::resume_state(const JobRow& row) {
  AttemptTable& attempts = parts_.jobs.attempts();
  std::vector<std::vector<FateRun>> fates;
  std::optional<AttemptRow> last;
  for (const AttemptRow& attempt : attempts.of_sheet(row.id, row.sheet)) {
    if (attempt.blank != row.blank) continue;
    fates.push_back(attempts.fates(attempt.id));
    last = attempt;
  }
  if (!last) return std::nullopt;
  return ResumeState{.last = *last,
                     .runs = merged_fates(last->strokes, fates),
                     .facts = {.strokes = last->strokes,
                               .same_device_session = last->end_kind != "media_out" &&
                                                      last->device_session ==
                                                          parts_.devices.session_of(last->device)}};
}

std::vector<Way> CutDispatcher::ways(const JobRow& row, const ActionRequest* wanted) {
  std::vector<Way> all;
  const std::string sheet = fmt::format("{{\"sheet\":{}}}", row.sheet);
  const std::vector<JobAction> allowed = allowed_actions(JobRepository::facts_of(row));
  const auto may = [&](JobAction action) {
    return std::find(allowed.begin(), allowed.end(), action) != allowed.end();
  };
  const auto add = [&](JobAction action, const std::string& body) {
    if (may(action)) all.push_back({std::string(name_of(action)), body});
  };
  if (row.held && !is_terminal(row.state))
    all.push_back({"release", fmt::format("{{\"job\":\"{}\"}}", row.id)});
  add(JobAction::Start, sheet);
  add(JobAction::Disarm, "{}");
  add(JobAction::Resume, "{}");
  if (row.state == JobState::Cutting) add(JobAction::Pause, "{}");
  if (row.state == JobState::Ready && knows_place(row, row.requested_device))
    add(JobAction::Arm,
        fmt::format(R"({{"sheet":{},"blank":{}{}}})", row.sheet, row.blank, accepting(row)));
  const std::optional<ResumeState> state =
      may(JobAction::ResumeFrom) ? resume_state(row) : std::nullopt;
  if (state) {
    ResumeRequest request{.from_path = row.state == JobState::Ready ? row.first_stroke : -1};
    if (wanted != nullptr && wanted->from_path) request.from_path = *wanted->from_path;
    if (wanted != nullptr) request.re_registered = wanted->registration == "re-registered";
    for (const ResumeRequest& one : ways_to_resume(state->runs, request, state->facts))
      all.push_back(resume_way(one));
  }
  const bool interrupted = row.state == JobState::Interrupted;
  if (interrupted || row.segment > 1) add(JobAction::RetrySheet, sheet);
  const bool whole =
      state && std::none_of(state->runs.begin(), state->runs.end(),
                            [](const FateRun& run) { return run.fate == PathFate::NotSent; });
  if (whole)
    add(JobAction::ConfirmResult, fmt::format("{{\"sheet\":{},\"good\":true}}", row.sheet));
  if (interrupted) add(JobAction::SkipSheet, sheet);
  return all;
}

}  // namespace popcut::daemon
