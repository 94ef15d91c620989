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

void read_sheet(FieldReader& fields, ActionWish& wish, bool required) {
  if (required) fields.need("sheet", "must be the number of the sheet, from 1");
  wish.sheet = small(fields.optional_integer("sheet", 1, kMostSheets));
}

void read_arm(FieldReader& fields, ActionWish& wish) {
  read_sheet(fields, wish, true);
  wish.blank = small(fields.optional_integer("blank", 1, kMostBlanks));
  wish.device = fields.text("device", "", line(64));
  wish.plan_sha256 = fields.text("plan_sha256", "", line(64));
}

void read_resume_from(FieldReader& fields, ActionWish& wish) {
  fields.need("from_path", "must be the stroke to go on from, counted from 0");
  fields.need("registration", "must be one of kept, re-registered");
  wish.from_path = fields.optional_integer("from_path", 0, kMostPaths);
  const std::vector<std::string> registrations{"kept", "re-registered"};
  if (const auto word = fields.optional_word("registration", registrations))
    wish.registration = registrations[*word];
  wish.accept_double_cut = fields.boolean("i_accept_double_cut", false);
  wish.skip_in_doubt = fields.boolean("skip_in_doubt", false);
}

ActionWish read_action(FieldReader& fields, JobAction action) {
  ActionWish wish;
  wish.action = action;
  switch (action) {
    case JobAction::Arm:
      read_arm(fields, wish);
      break;
    case JobAction::Start:
      read_sheet(fields, wish, false);
      break;
    case JobAction::Cancel:
      wish.reason = fields.text("reason", "", line(200));
      break;
    case JobAction::ConfirmResult:
      read_sheet(fields, wish, true);
      fields.need("good", "must be true or false: is the sheet usable?");
      wish.good = fields.optional_boolean("good");
      break;
    case JobAction::RetrySheet:
    case JobAction::SkipSheet:
      read_sheet(fields, wish, true);
      break;
    case JobAction::ResumeFrom:
      read_resume_from(fields, wish);
      break;
    case JobAction::Disarm:
    case JobAction::Pause:
    case JobAction::Resume:
      break;
  }
  return wish;
}

}  // namespace

void act_on_job(const Request& request, Service& service, JobAction action, const Shop& shop,
                const Reply& reply) {
  const auto wish = read_body_as<ActionWish>(
      request, shop.limits.json_depth,
      [action](FieldReader& fields) { return read_action(fields, action); });
  if (!wish) return reply(problem_response(wish.error(), request));
  const bool any_rev =
      action == JobAction::Pause || action == JobAction::Cancel || action == JobAction::Disarm;
  answer_once(request, service, reply, [&] {
    const Answer<Job> before = service.job(request.params[0]);
    if (!before) return problem_response(before.error(), request);
    if (const auto not_theirs = check_owner(request, before->owner))
      return problem_response(*not_theirs, request);
    const Answer<std::int64_t> rev =
        wanted_rev(request, any_rev ? std::optional(before->rev) : std::nullopt);
    if (!rev) return problem_response(rev.error(), request);
    const Answer<Job> after = service.act(request.principal, before->id, *rev, *wish);
    if (!after) return problem_response(after.error(), request);
    return revised(200, after->rev, job_text(*after));
  });
}

}  // namespace popcut::daemon::http::handle
