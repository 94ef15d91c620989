// SPDX-License-Identifier: MIT

#include "daemon/http/api/handler_kit.hpp"
#include "daemon/http/api/handlers.hpp"
#include "daemon/http/api/input.hpp"
#include "daemon/http/api/render.hpp"

namespace popcut::daemon::http {
namespace {

constexpr InputRule kSheet = whole("sheet", 1, kMostSheets);
constexpr InputRule kNeededSheet = kSheet.required("must be the sheet number, counted from 1");

}  // namespace

const Body body::kArm{
    .schema = "Arm",
    .fields =
        {kNeededSheet, whole("blank", 1, kMostBlanks).described("default: the current one"),
         text("device", kIdLimit)
             .described("the cutter that holds the sheet; must match the device of the job "
                        "if it has one"),
         text("plan_sha256", kIdLimit).described("if given, it must match the sha256 of the plan"),
         texts("accept_warnings", kMostAcceptedWarnings, kWarningCodeLimit)
             .described("codes of unaccepted_warnings: cut although the cut may be spoiled")},
    .description = "What the operator has loaded.",
    .example = R"({"sheet": 1})"};

const Body body::kStart{.schema = "Start", .fields = {kSheet}, .is_optional = true};

const Body body::kCancel{.schema = "Cancel",
                         .fields = {text("reason", kReasonLimit)},
                         .example = R"({"reason": "wrong paper"})",
                         .is_optional = true};

const Body body::kConfirmResult{
    .schema = "ConfirmResult",
    .fields = {kNeededSheet,
               flag("good")
                   .required("must be true or false: is the sheet usable?")
                   .described("false: the job stays interrupted, with the reason result_bad")},
    .example = R"({"sheet": 1, "good": true})"};

const Body body::kSheetChoice{
    .schema = "SheetChoice", .fields = {kNeededSheet}, .example = R"({"sheet": 1})"};

const Body body::kResumeFrom{
    .schema = "ResumeFrom",
    .fields = {whole("from_path", 0, kMostPaths)
                   .required("must be the path to continue from, counted from 0")
                   .with_schema(R"({"type": "integer", "minimum": 0})")
                   .described("first path to cut, counted from 0 as in the ledger"),
               word("registration", "kept re-registered")
                   .required("must be one of kept, re-registered")
                   .described("kept: the sheet has not moved; re-registered: you loaded it again "
                              "in the same place"),
               flag("i_accept_double_cut")
                   .described("true: popcutd may cut a path a second time if it is cut already or "
                              "in doubt"),
               flag("skip_in_doubt")
                   .described("true: paths in doubt may come before from_path; popcutd does not "
                              "cut them")},
    .description = "Continue on the same blank.",
    .example = R"({"from_path": 3, "registration": "kept"})"};

namespace handle {
namespace {

ActionRequest read_action(BodyReader& body, JobAction action) {
  ActionRequest wanted;
  wanted.action = action;
  switch (action) {
    case JobAction::Arm:
      wanted.sheet = body.optional_whole("sheet");
      wanted.blank = body.optional_whole("blank");
      wanted.device = body.text("device");
      wanted.plan_sha256 = body.text("plan_sha256");
      wanted.accept_warnings = body.texts("accept_warnings");
      break;
    case JobAction::Cancel:
      wanted.reason = body.text("reason");
      break;
    case JobAction::ConfirmResult:
      wanted.sheet = body.optional_whole("sheet");
      wanted.good = body.optional_flag("good");
      break;
    case JobAction::Start:
    case JobAction::RetrySheet:
    case JobAction::SkipSheet:
      wanted.sheet = body.optional_whole("sheet");
      break;
    case JobAction::ResumeFrom:
      wanted.from_path = body.optional_large("from_path");
      wanted.registration = body.optional_word("registration").value_or("");
      wanted.accept_double_cut = body.flag("i_accept_double_cut");
      wanted.skip_in_doubt = body.flag("skip_in_doubt");
      break;
    case JobAction::Disarm:
    case JobAction::Pause:
    case JobAction::Resume:
      break;
  }
  return wanted;
}

const Body& body_of(JobAction action) {
  switch (action) {
    case JobAction::Arm:
      return body::kArm;
    case JobAction::Start:
      return body::kStart;
    case JobAction::Cancel:
      return body::kCancel;
    case JobAction::ConfirmResult:
      return body::kConfirmResult;
    case JobAction::RetrySheet:
    case JobAction::SkipSheet:
      return body::kSheetChoice;
    case JobAction::ResumeFrom:
      return body::kResumeFrom;
    case JobAction::Disarm:
    case JobAction::Pause:
    case JobAction::Resume:
      break;
  }
  return body::kNothing;
}

}  // namespace

void act_on_job(const Request& request, Service& service, JobAction action,
                const HandlerContext& context, const Reply& reply) {
  const auto wanted =
      read_body<ActionRequest>(request, context, body_of(action),
                               [action](BodyReader& body) { return read_action(body, action); });
  if (!wanted) {
    Problem problem = wanted.error();
    if (const Answer<Job> job = service.jobs.find(request.params[0]))
      problem.next_actions = job->next_actions;
    return reply(problem_response(problem, request));
  }
  const bool any_rev =
      action == JobAction::Pause || action == JobAction::Cancel || action == JobAction::Disarm;
  // A moving knife stops even if nothing can be looked up or stored now.
  const bool to_the_knife = action == JobAction::Pause || action == JobAction::Cancel;
  const int status = answer_once(request, service, reply, [&] {
    const Answer<Job> before = service.jobs.find(request.params[0]);
    if (!before) return problem_response(before.error(), request);
    if (const auto not_theirs = check_owner(request, before->owner))
      return problem_response(*not_theirs, request);
    const Answer<std::int64_t> rev =
        wanted_rev(request, any_rev ? std::optional(before->rev) : std::nullopt);
    if (!rev) return problem_response(rev.error(), request);
    const Answer<Job> after = service.cutting.act(request.principal, before->id, *rev, *wanted);
    if (!after) return problem_response(after.error(), request);
    return revised(200, after->rev, job_text(*after));
  });
  if (to_the_knife && status >= 500)
    service.cutting.stop_unrecorded(request.principal, request.params[0], action);
}

}  // namespace handle
}  // namespace popcut::daemon::http
