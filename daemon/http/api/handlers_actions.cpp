// SPDX-License-Identifier: MIT

#include "daemon/http/api/handler_kit.hpp"
#include "daemon/http/api/handlers.hpp"
#include "daemon/http/api/json_body.hpp"
#include "daemon/http/api/render.hpp"

namespace popcut::daemon::http::handle {
namespace {

constexpr std::int64_t kMostSheets = 10'000;
constexpr std::int64_t kMostBlanks = 1'000'000;
constexpr std::size_t kMostWarnings = 100;
constexpr std::int64_t kMostPaths = std::int64_t{1} << 40;

std::optional<int> small(const std::optional<std::int64_t>& value) {
  return value ? std::optional<int>(static_cast<int>(*value)) : std::nullopt;
}

void read_sheet(FieldReader& fields, ActionRequest& wanted, bool required) {
  if (required) fields.need("sheet", "must be the sheet number, counted from 1");
  wanted.sheet = small(fields.optional_integer("sheet", 1, kMostSheets));
}

void read_arm(FieldReader& fields, ActionRequest& wanted) {
  read_sheet(fields, wanted, true);
  wanted.blank = small(fields.optional_integer("blank", 1, kMostBlanks));
  wanted.device = fields.text("device", "", line(64));
  wanted.plan_sha256 = fields.text("plan_sha256", "", line(64));
  wanted.accept_warnings = fields.optional_texts("accept_warnings", kMostWarnings, line(40))
                               .value_or(std::vector<std::string>());
}

void read_resume_from(FieldReader& fields, ActionRequest& wanted) {
  fields.need("from_path", "must be the path to continue from, counted from 0");
  fields.need("registration", "must be one of kept, re-registered");
  wanted.from_path = fields.optional_integer("from_path", 0, kMostPaths);
  const std::vector<std::string> registrations{"kept", "re-registered"};
  if (const auto word = fields.optional_word("registration", registrations))
    wanted.registration = registrations[*word];
  wanted.accept_double_cut = fields.boolean("i_accept_double_cut", false);
  wanted.skip_in_doubt = fields.boolean("skip_in_doubt", false);
}

ActionRequest read_action(FieldReader& fields, JobAction action) {
  ActionRequest wanted;
  wanted.action = action;
  switch (action) {
    case JobAction::Arm:
      read_arm(fields, wanted);
      break;
    case JobAction::Start:
      read_sheet(fields, wanted, false);
      break;
    case JobAction::Cancel:
      wanted.reason = fields.text("reason", "", line(200));
      break;
    case JobAction::ConfirmResult:
      read_sheet(fields, wanted, true);
      fields.need("good", "must be true or false: is the sheet usable?");
      wanted.good = fields.optional_boolean("good");
      break;
    case JobAction::RetrySheet:
    case JobAction::SkipSheet:
      read_sheet(fields, wanted, true);
      break;
    case JobAction::ResumeFrom:
      read_resume_from(fields, wanted);
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
      [action](FieldReader& fields) { return read_action(fields, action); });
  if (!wanted) {
    Problem problem = wanted.error();
    if (const Answer<Job> job = service.jobs.find(request.params[0]))
      problem.next_actions = job->next_actions;
    return reply(problem_response(problem, request));
  }
  const bool any_rev =
      action == JobAction::Pause || action == JobAction::Cancel || action == JobAction::Disarm;
  // A knife that moves stops whether or not anything can be looked up or stored now.
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

}  // namespace popcut::daemon::http::handle
