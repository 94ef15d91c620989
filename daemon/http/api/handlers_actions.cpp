// SPDX-License-Identifier: MIT
#include <nlohmann/json.hpp>

#include "daemon/http/api/handler_kit.hpp"
#include "daemon/http/api/handlers.hpp"
#include "daemon/http/api/json_body.hpp"
#include "daemon/http/api/render.hpp"

namespace popcut::daemon::http::handle {
namespace {

constexpr std::int64_t kMostSheets = 10'000;
constexpr std::int64_t kMostBlanks = 1'000'000;
constexpr std::int64_t kMostPaths = std::int64_t{1} << 40;

std::optional<int> small(const std::optional<std::int64_t>& value) {
  return value ? std::optional<int>(static_cast<int>(*value)) : std::nullopt;
}

void read_sheet(Members& members, ActionRequest& wanted, bool required) {
  if (required) members.require("sheet", "must be the sheet number, counted from 1");
  wanted.sheet = small(members.integer("sheet", 1, kMostSheets));
}

void read_arm(Members& members, ActionRequest& wanted) {
  read_sheet(members, wanted, true);
  wanted.blank = small(members.integer("blank", 1, kMostBlanks));
  wanted.device = members.text("device", 64).value_or("");
  wanted.plan_sha256 = members.text("plan_sha256", 64).value_or("");
}

void read_resume_from(Members& members, ActionRequest& wanted) {
  members.require("from_path", "must be the path to continue from, counted from 0");
  members.require("registration", "must be one of kept, re-registered");
  wanted.from_path = members.integer("from_path", 0, kMostPaths);
  wanted.registration = members.word("registration", {"kept", "re-registered"}).value_or("");
  wanted.accept_double_cut = members.boolean("i_accept_double_cut").value_or(false);
  wanted.skip_in_doubt = members.boolean("skip_in_doubt").value_or(false);
}

ActionRequest read_action(Members& members, JobAction action) {
  ActionRequest wanted;
  wanted.action = action;
  switch (action) {
    case JobAction::Arm:
      read_arm(members, wanted);
      break;
    case JobAction::Start:
      read_sheet(members, wanted, false);
      break;
    case JobAction::Cancel:
      wanted.reason = members.text("reason", 200).value_or("");
      break;
    case JobAction::ConfirmResult:
      read_sheet(members, wanted, true);
      members.require("good", "must be true or false: is the sheet usable?");
      wanted.good = members.boolean("good");
      break;
    case JobAction::RetrySheet:
    case JobAction::SkipSheet:
      read_sheet(members, wanted, true);
      break;
    case JobAction::ResumeFrom:
      read_resume_from(members, wanted);
      break;
    case JobAction::Disarm:
    case JobAction::Pause:
    case JobAction::Resume:
      break;
  }
  return wanted;
}

}  // namespace

void act_on_job(const Request& request, Service& service, JobAction action,
                const HandlerContext& context, const Reply& reply) {
  const auto wanted = read_body_as<ActionRequest>(
      request, context.limits.json_depth,
      [action](Members& members) { return read_action(members, action); });
  if (!wanted) return reply(problem_response(wanted.error(), request));
  const bool any_rev =
      action == JobAction::Pause || action == JobAction::Cancel || action == JobAction::Disarm;
  answer_once(request, service, reply, [&] {
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
}

}  // namespace popcut::daemon::http::handle
