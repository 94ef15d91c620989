// SPDX-License-Identifier: MIT
#include <map>
#include <random>
#include <set>
#include <string>
#include <utility>

#include <catch2/catch.hpp>

#include "daemon/jobs/resume.hpp"
#include "daemon/jobs/rules.hpp"
#include "daemon/model/problem.hpp"

namespace job_rules_test {

using namespace popcut::daemon;

namespace {

// One letter a step, so that the whole state machine fits a screen.
char letter(Step step) {
  constexpr std::string_view letters = ".=QPRACUINFX";
  return letters.at(static_cast<std::size_t>(step));
}

}  // namespace

TEST_CASE("every action does in every state what the manual says", "[daemon][jobs]") {
  // Columns: arm disarm start pause resume cancel confirm retry skip resume-from.
  // . refused, = stays, R ready, A armed, C cutting, N next sheet, X cancelled.
  const std::map<JobState, std::string> table{
      {JobState::Queued, ".....X...."},      {JobState::Planning, ".....X...."},
      {JobState::Ready, "A....X.=N="},       {JobState::Armed, ".RC..X...."},
      {JobState::Cutting, "...===...."},     {JobState::Paused, "...=C=...."},
      {JobState::Interrupted, ".....XNRNR"}, {JobState::Done, ".........."},
      {JobState::Failed, ".........."},      {JobState::Cancelled, ".........."}};
  REQUIRE(table.size() == all_states().size());
  for (const JobState state : all_states()) {
    std::string row;
    for (const JobAction action : all_actions()) row += letter(step_of(state, action));
    CAPTURE(name_of(state));
    CHECK(row == table.at(state));
  }
}

TEST_CASE("every event does in every state what the manual says", "[daemon][jobs]") {
  // Columns: plan begins, plan comes, plan fails, arm lapses, cut refused, cut held, cut completes,
  // cut unconfirmed, cut breaks, cut stops, restarts, intents surface, plans again, found again. Q
  // queued, P planning, C cutting, U paused, I interrupted, F failed.
  const std::map<JobState, std::string> table{
      {JobState::Queued, "PRF.........Q."},      {JobState::Planning, ".RF.......Q.Q."},
      {JobState::Ready, "...........IQ."},       {JobState::Armed, "...R......RI.."},
      {JobState::Cutting, "....RUNIIXII.."},     {JobState::Paused, "....R.NIIXII.."},
      {JobState::Interrupted, "...........I.C"}, {JobState::Done, ".............."},
      {JobState::Failed, ".............."},      {JobState::Cancelled, ".............."}};
  for (const JobState state : all_states()) {
    std::string row;
    for (const JobEvent event : all_events()) row += letter(step_of(state, event));
    CAPTURE(name_of(state));
    CHECK(row == table.at(state));
  }
}

TEST_CASE("a knife cuts only after arm and start or after pause and resume", "[daemon][jobs]") {
  for (const JobState state : all_states()) {
    for (const JobEvent event : all_events()) {
      const JobState next = state_after(state, step_of(state, event), 1, 2);
      if (next == state) continue;
      CHECK(next != JobState::Armed);
      // It never stopped; only its node was not heard of.
      if (event == JobEvent::CutFoundAgain && state == JobState::Interrupted) continue;
      CHECK(next != JobState::Cutting);
    }
    for (const JobAction action : all_actions()) {
      const JobState next = state_after(state, step_of(state, action), 1, 2);
      if (next == state) continue;
      CHECK_FALSE(is_terminal(state));
      if (next == JobState::Armed) CHECK((state == JobState::Ready && action == JobAction::Arm));
      if (next == JobState::Cutting)
        CHECK(((state == JobState::Armed && action == JobAction::Start) ||
               (state == JobState::Paused && action == JobAction::Resume)));
    }
  }
}

TEST_CASE("a finished sheet leads to the next one and after the last to done", "[daemon][jobs]") {
  CHECK(state_after(JobState::Cutting, Step::NextSheet, 1, 2) == JobState::Ready);
  CHECK(state_after(JobState::Cutting, Step::NextSheet, 2, 2) == JobState::Done);
  CHECK(state_after(JobState::Interrupted, Step::NextSheet, 1, 1) == JobState::Done);
}

TEST_CASE("the allowed actions depend on hold and on earlier requests", "[daemon][jobs]") {
  CHECK(step_of({.state = JobState::Ready, .held = true}, JobAction::Arm) == Step::Refused);
  CHECK(step_of({.state = JobState::Ready}, JobAction::Arm) == Step::ToArmed);
  CHECK(step_of({.state = JobState::Ready}, JobAction::ResumeFrom) == Step::Refused);
  CHECK(step_of({.state = JobState::Ready, .begun = true}, JobAction::ResumeFrom) == Step::Stays);
  CHECK(step_of({.state = JobState::Cutting}, JobAction::Resume) == Step::Refused);
  CHECK(step_of({.state = JobState::Cutting, .pausing = true}, JobAction::Resume) == Step::Stays);
  CHECK(step_of({.state = JobState::Paused, .cancelling = true}, JobAction::Resume) ==
        Step::Refused);
  CHECK(step_of({.state = JobState::Cutting, .cancelling = true}, JobAction::Cancel) ==
        Step::Stays);
  const auto lawful = allowed_actions({.state = JobState::Cutting});
  CHECK(lawful == std::vector<JobAction>{JobAction::Pause, JobAction::Cancel});
}

TEST_CASE("a submitter may cancel an own job and do nothing else", "[daemon][jobs]") {
  for (const JobAction action : all_actions()) {
    CHECK(role_for(action, false) == Role::Operator);
    CHECK(role_for(action, true) ==
          (action == JobAction::Cancel ? Role::Submitter : Role::Operator));
  }
}

TEST_CASE("names of states actions and roles are read back", "[daemon][jobs]") {
  for (const JobState state : all_states()) CHECK(job_state_from(name_of(state)) == state);
  for (const JobAction action : all_actions()) CHECK(job_action_from(name_of(action)) == action);
  for (const Role role : {Role::Viewer, Role::Submitter, Role::Operator, Role::Admin})
    CHECK(role_from(name_of(role)) == role);
  CHECK_FALSE(job_state_from("Queued"));
  CHECK(name_of(JobAction::ConfirmResult) == "confirm-result");
}

TEST_CASE("every kind of problem has its own status and slug and title", "[daemon][jobs]") {
  std::set<std::string_view> slugs, titles;
  for (int kind = 0; kind <= static_cast<int>(ProblemKind::Internal); ++kind) {
    const auto one = static_cast<ProblemKind>(kind);
    CHECK(status_of(one) >= 400);
    CHECK(status_of(one) < 600);
    CHECK(slugs.insert(slug_of(one)).second);
    CHECK(titles.insert(title_of(one)).second);
  }
  CHECK(status_of(ProblemKind::DiskFull) == 507);
  CHECK(status_of(ProblemKind::Stale) == 412);
  CHECK(status_of(ProblemKind::QueueFull) == 503);
  CHECK(slug_of(ProblemKind::WrongHost) == "wrong-host");
  const Problem problem = problem_from({popcut::ErrorKind::OutOfRange, "/strokes/3", "too strong"});
  CHECK(problem.kind == ProblemKind::Validation);
  CHECK(problem.errors.at(0).pointer == "/strokes/3");
}

namespace {

constexpr PathFate N = PathFate::NotSent, D = PathFate::InDoubt, C = PathFate::Certain;

std::string drawn(const std::vector<FateRun>& runs) {
  std::string text;
  for (const FateRun& run : runs)
    text.append(static_cast<std::size_t>(run.paths.last - run.paths.first + 1), run.fate == C ? 'c'
                                                                                : run.fate == D
                                                                                    ? 'd'
                                                                                    : '.');
  return text;
}

}  // namespace

TEST_CASE("attempts at one blank add up to one ledger", "[daemon][jobs]") {
  CHECK(drawn(merged_fates(6, {})) == "......");
  CHECK(drawn(merged_fates(6, {{{{0, 2}, C}, {{3, 4}, D}}})) == "cccdd.");
  // The second attempt began at stroke 3 and got as far as 4.
  CHECK(drawn(merged_fates(6, {{{{0, 2}, C}, {{3, 4}, D}}, {{{3, 4}, C}, {{5, 5}, D}}})) ==
        "cccccd");
  // What was skipped in doubt stays so; what was certain is not made doubtful by a second cut.
  CHECK(drawn(merged_fates(6, {{{{0, 2}, C}, {{3, 3}, D}}, {{{4, 5}, C}}})) == "cccdcc");
  CHECK(drawn(merged_fates(4, {{{{0, 3}, C}}, {{{1, 3}, D}}})) == "cccc");
  Ledger ledger;
  fill_ledger(ledger, merged_fates(6, {{{{0, 2}, C}, {{3, 3}, D}}}));
  CHECK(ledger.certain_upto == 2);
  CHECK(ledger.in_doubt.at(0).first == 3);
  CHECK(ledger.not_sent.at(0).last == 5);
}

TEST_CASE("resuming skips no path and cuts none twice unless a person decides so",
          "[daemon][jobs]") {
  const ResumeFacts here{.strokes = 10, .same_device_session = true};
  const auto runs = merged_fates(10, {{{{0, 3}, C}, {{4, 5}, D}}});  // ccccdd....
  const auto may = [&](ResumeRequest request) {
    return may_resume(runs, request, here).has_value();
  };
  CHECK(may({.from_path = 4, .accept_double_cut = true}));
  CHECK_FALSE(may({.from_path = 4}));
  CHECK_FALSE(may({.from_path = 5, .accept_double_cut = true, .skip_in_doubt = true}));
  CHECK(may({.from_path = 6, .skip_in_doubt = true}));
  CHECK_FALSE(may({.from_path = 6}));
  CHECK_FALSE(may({.from_path = 7, .skip_in_doubt = true}));
  CHECK(may({.from_path = 0, .accept_double_cut = true}));
  CHECK_FALSE(may({.from_path = 0}));
  CHECK_FALSE(may({.from_path = 10, .accept_double_cut = true, .skip_in_doubt = true}));
  CHECK_FALSE(may({.from_path = -1, .accept_double_cut = true}));
  const auto nothing_sent = merged_fates(10, {{}});
  CHECK(may_resume(nothing_sent, {.from_path = 0}, here));
  CHECK_FALSE(may_resume(nothing_sent, {.from_path = 1}, here));
  const ResumeFacts away{.strokes = 10, .same_device_session = false};
  CHECK_FALSE(may_resume(runs, {.from_path = 4, .accept_double_cut = true}, away));
  CHECK(may_resume(runs, {.from_path = 4, .re_registered = true, .accept_double_cut = true}, away));
}

TEST_CASE("a valid resume needs a decision for each path in doubt", "[daemon][jobs]") {
  std::mt19937 random(20261121);
  for (int round = 0; round < 3000; ++round) {
    const std::int64_t strokes = 1 + static_cast<std::int64_t>(random() % 12);
    std::vector<std::vector<FateRun>> attempts;
    for (unsigned i = random() % 3; i-- > 0;) {
      std::vector<FateRun> runs;
      std::int64_t at = static_cast<std::int64_t>(random() % 4);
      while (at < strokes) {
        const std::int64_t last =
            std::min<std::int64_t>(strokes - 1, at + static_cast<std::int64_t>(random() % 4));
        runs.push_back({{at, last}, static_cast<PathFate>(random() % 3)});
        at = last + 1;
      }
      attempts.push_back(runs);
    }
    const auto runs = merged_fates(strokes, attempts);
    const std::string fates = drawn(runs);
    REQUIRE(fates.size() == static_cast<std::size_t>(strokes));
    const ResumeRequest request{.from_path = static_cast<std::int64_t>(random() % 14),
                                .accept_double_cut = random() % 2 == 0,
                                .skip_in_doubt = random() % 2 == 0};
    CAPTURE(round, fates, request.from_path, request.accept_double_cut, request.skip_in_doubt);
    if (!may_resume(runs, request, {.strokes = strokes, .same_device_session = true})) continue;
    REQUIRE(request.from_path < strokes);
    const auto from = static_cast<std::size_t>(request.from_path);
    CHECK(fates.substr(0, from).find('.') == std::string::npos);
    if (fates.substr(0, from).find('d') != std::string::npos) CHECK(request.skip_in_doubt);
    if (fates.substr(from).find_first_of("cd") != std::string::npos)
      CHECK(request.accept_double_cut);
  }
}

TEST_CASE("who is refused a resume learns all reasons and requests that pass", "[daemon][jobs]") {
  const auto runs = merged_fates(10, {{{{0, 3}, C}, {{4, 5}, D}}});  // ccccdd....
  const ResumeFacts away{.strokes = 10, .same_device_session = false};
  const auto why = may_resume(runs, {.from_path = 5}, away).error();
  CHECK(why.find("re-registered") != std::string::npos);
  CHECK(why.find("paths 4..5 are in doubt") != std::string::npos);
  const auto ways = possible_resumes(runs, {.from_path = 5}, away);
  REQUIRE(ways.size() == 2);
  CHECK(ways[0].from_path == 6);
  CHECK(ways[0].re_registered);
  CHECK(ways[0].skip_in_doubt);
  CHECK_FALSE(ways[0].accept_double_cut);
  CHECK(ways[1].from_path == 4);
  CHECK(ways[1].accept_double_cut);
  CHECK_FALSE(ways[1].skip_in_doubt);
  // What was wanted comes first if more words make it right.
  CHECK(possible_resumes(runs, {.from_path = 0}, away).front().from_path == 0);
  CHECK(possible_resumes(runs, {.from_path = 99}, away).front().from_path == 6);
  // All of any: each passes, and nothing in it can be left out.
  std::mt19937 random(20261123);
  for (int round = 0; round < 2000; ++round) {
    const std::int64_t strokes = 1 + static_cast<std::int64_t>(random() % 12);
    std::vector<FateRun> given;
    for (std::int64_t at = 0; at < strokes; ++at)
      given.push_back({{at, at}, static_cast<PathFate>(random() % 3)});
    const auto mixed = merged_fates(strokes, {given});
    const ResumeFacts facts{.strokes = strokes, .same_device_session = random() % 2 == 0};
    const ResumeRequest wanted{.from_path = static_cast<std::int64_t>(random() % 14) - 1};
    const auto all = possible_resumes(mixed, wanted, facts);
    CAPTURE(round, strokes, wanted.from_path);
    if (may_resume(mixed, wanted, facts)) CHECK(all.front().from_path == wanted.from_path);
    for (const ResumeRequest& way : all) {
      CHECK(may_resume(mixed, way, facts));
      for (auto flag : {&ResumeRequest::re_registered, &ResumeRequest::accept_double_cut,
                        &ResumeRequest::skip_in_doubt}) {
        ResumeRequest less = way;
        if (!std::exchange(less.*flag, false)) continue;
        CHECK_FALSE(may_resume(mixed, less, facts));
      }
    }
  }
}

}  // namespace job_rules_test
