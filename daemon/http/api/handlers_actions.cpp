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

void read_sheet(Members& members, ActionWish& wish, bool required) {
  if (required) members.require("sheet", "must be the number of the sheet, from 1");
  wish.sheet = small(members.integer("sheet", 1, kMostSheets));
}

void read_arm(Members& members, ActionWish& wish) {
  read_sheet(members, wish, true);
  wish.blank = small(members.integer("blank", 1, kMostBlanks));
  wish.device = members.text("device", 64).value_or("");
  wish.plan_sha256 = members.text("plan_sha256", 64).value_or("");
}

void read_resume_from(Members& members, ActionWish& wish) {
  members.require("from_path", "must be the stroke to go on from, counted from 0");
  members.require("registration", "must be one of kept, re-registered");
  wish.from_path = members.integer("from_path", 0, kMostPaths);
  wish.registration = members.word("registration", {"kept", "re-registered"}).value_or("");
  wish.accept_double_cut = members.boolean("i_accept_double_cut").value_or(false);
  wish.skip_in_doubt = members.boolean("skip_in_doubt").value_or(false);
}

ActionWish read_action(Members& members, JobAction action) {
  ActionWish wish;
  wish.action = action;
  switch (action) {
    case JobAction::Arm:
      read_arm(members, wish);
      break;
    case JobAction::Start:
      read_sheet(members, wish, false);
      break;
    case JobAction::Cancel:
      wish.reason = members.text("reason", 200).value_or("");
      break;
    case JobAction::ConfirmResult:
      read_sheet(members, wish, true);
      members.require("good", "must be true or false: is the sheet usable?");
      wish.good = members.boolean("good");
      break;
    case JobAction::RetrySheet:
    case JobAction::SkipSheet:
      read_sheet(members, wish, true);
      break;
    case JobAction::ResumeFrom:
      read_resume_from(members, wish);
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
  const auto wish =
      read_body_as<ActionWish>(request, shop.limits.json_depth,
                               [action](Members& members) { return read_action(members, action); });
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
