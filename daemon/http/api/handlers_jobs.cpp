// SPDX-License-Identifier: MIT
#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "daemon/http/api/handler_kit.hpp"
#include "daemon/http/api/handlers.hpp"
#include "daemon/http/api/json_body.hpp"
#include "daemon/http/api/render.hpp"

namespace popcut::daemon::http::handle {
namespace {

JobCreate read_job(Members& members) {
  JobCreate wanted;
  wanted.design = members.text("design", 80).value_or("");
  wanted.plan = members.text("plan", 80).value_or("");
  if (members.has("design") == members.has("plan"))
    members.fault(members.has("plan") ? "plan" : "design", "one_of",
                  "name either a design or a plan");
  wanted.material = members.text("material", 64).value_or("");
  wanted.device = members.text("device", 64).value_or("");
  wanted.options = members.options("options");
  wanted.copies = static_cast<int>(members.integer("copies", 1, 1000).value_or(1));
  wanted.priority = static_cast<int>(members.integer("priority", -10, 10).value_or(0));
  wanted.name = members.text_or_empty("name", 120).value_or("");
  wanted.note = members.text_or_empty("note", 2000, true).value_or("");
  wanted.tags = members.texts("tags", 20, 40);
  // No cutter feeds itself so that it could go on alone.
  static_cast<void>(members.word("on_sheet_done", {"wait"}));
  return wanted;
}

JobPatch read_patch(Members& members) {
  JobPatch patch;
  if (const auto priority = members.integer("priority", -10, 10))
    patch.priority = static_cast<int>(*priority);
  patch.name = members.text_or_empty("name", 120);
  patch.note = members.text_or_empty("note", 2000, true);
  patch.device = members.text_or_empty("device", 64);
  return patch;
}

JobFilter read_filter(const Request& request, std::vector<RequestFault>& faults) {
  JobFilter filter;
  filter.owner = query_text(request, "owner").value_or("");
  filter.device = query_text(request, "device").value_or("");
  filter.since = query_time(request, "since", faults);
  std::string states = query_text(request, "state").value_or("");
  while (!states.empty()) {
    const std::size_t comma = std::min(states.find(','), states.size());
    const std::string word = states.substr(0, comma);
    if (const auto state = job_state_from(word))
      filter.states.push_back(*state);
    else
      faults.push_back({"?state", "word",
                        "must be a comma-separated list of states: queued, planning, ready, armed, "
                        "cutting, paused, interrupted, done, failed, cancelled"});
    if (!faults.empty()) break;
    states.erase(0, comma + 1);
  }
  return filter;
}

Response job_response(int status, const Job& job) {
  return revised(status, job.rev, job_text(job));
}

Response answer_job(const Request& request, int status, const Answer<Job>& job) {
  return job ? job_response(status, *job) : problem_response(job.error(), request);
}

std::optional<int> sheet_number(const Request& request, const Reply& reply) {
  const std::optional<int> number = path_number(request.params[1]);
  if (!number)
    reply(problem_response(Problem{ProblemKind::NotFound, "sheet numbers start at 1"}, request));
  return number;
}

std::string read_job_id(Members& members) {
  members.require("job", "must be the id of a job");
  return members.text("job", 64).value_or("");
}

// The job that a body names, held against an If-Match if there is one.
std::optional<Problem> check_named(const Request& request, Service& service,
                                   const std::string& id) {
  if (!request.header("if-match")) return std::nullopt;
  const Answer<Job> job = service.jobs.find(id);
  return job ? check_seen(request, *job) : job.error();
}

void set_held(const Request& request, Service& service, const HandlerContext& context, bool held,
              const Reply& reply) {
  const auto job = read_body_as<std::string>(request, context.limits.json_depth, read_job_id);
  if (!job) return reply(problem_response(job.error(), request));
  answer_once(request, service, reply, [&] {
    if (const auto stale = check_named(request, service, *job))
      return problem_response(*stale, request);
    return answer_job(request, 200, service.jobs.hold(request.principal, *job, held));
  });
}

}  // namespace

void create_job(const Request& request, Service& service, const HandlerContext& context,
                Reply reply) {
  const auto wanted = read_body_as<JobCreate>(request, context.limits.json_depth, read_job);
  if (!wanted) return reply(problem_response(wanted.error(), request));
  answer_once(request, service, reply, [&] {
    const Answer<Job> job = service.jobs.create(request.principal, *wanted);
    if (!job) return problem_response(job.error(), request);
    Response response = job_response(201, *job);
    response.headers.push_back({"Location", "/v1/jobs/" + job->id});
    return response;
  });
}

void list_jobs(const Request& request, Service& service, const HandlerContext&, Reply reply) {
  constexpr char kList = 'j';
  std::vector<RequestFault> faults;
  const PageRequest wanted = page_request(request, kList, faults);
  const JobFilter filter = read_filter(request, faults);
  if (!faults.empty()) return reply(problem_response(validation(std::move(faults)), request));
  Answer<Page<Job>> page = service.jobs.list(filter, wanted);
  if (!page) return reply(problem_response(page.error(), request));
  reply(page_response(std::move(*page), kList, [](const Job& job) { return job_text(job); }));
}

void get_job(const Request& request, Service& service, const HandlerContext&, Reply reply) {
  reply(answer_job(request, 200, service.jobs.find(request.params[0])));
}

void patch_job(const Request& request, Service& service, const HandlerContext& context,
               Reply reply) {
  const auto patch = read_body_as<JobPatch>(request, context.limits.json_depth, read_patch);
  if (!patch) return reply(problem_response(patch.error(), request));
  if (!patch->priority && !patch->name && !patch->note && !patch->device)
    return reply(problem_response(
        validation({{"", "empty", "must contain at least one of priority, name, note, device"}}),
        request));
  const Answer<std::int64_t> rev = wanted_rev(request, std::nullopt);
  if (!rev) return reply(problem_response(rev.error(), request));
  answer_once(request, service, reply, [&] {
    const Answer<Job> job = service.jobs.find(request.params[0]);
    if (!job) return problem_response(job.error(), request);
    if (const auto not_theirs = check_owner(request, job->owner))
      return problem_response(*not_theirs, request);
    return answer_job(request, 200, service.jobs.patch(request.principal, job->id, *rev, *patch));
  });
}

void delete_job(const Request& request, Service& service, const HandlerContext&, Reply reply) {
  const Answer<Job> job = service.jobs.find(request.params[0]);
  if (!job) return reply(problem_response(job.error(), request));
  if (const auto not_theirs = check_owner(request, job->owner))
    return reply(problem_response(*not_theirs, request));
  if (const auto stale = check_seen(request, *job)) return reply(problem_response(*stale, request));
  const Answer<void> gone = service.jobs.remove(request.principal, job->id);
  if (!gone) return reply(problem_response(gone.error(), request));
  reply(empty_response());
}

void job_sheets(const Request& request, Service& service, const HandlerContext&, Reply reply) {
  constexpr char kList = 's';
  std::vector<RequestFault> faults;
  const PageRequest wanted = page_request(request, kList, faults, kUsualWhole);
  if (!faults.empty()) return reply(problem_response(validation(std::move(faults)), request));
  Answer<std::vector<SheetRecord>> sheets = service.jobs.sheets(request.params[0]);
  if (!sheets) return reply(problem_response(sheets.error(), request));
  reply(page_response(
      page_of(std::move(*sheets), wanted,
              [](const SheetRecord& sheet) { return fmt::format("{:08}", sheet.number); }),
      kList, [](const SheetRecord& sheet) { return dump(to_json(sheet)); }));
}

void job_sheet(const Request& request, Service& service, const HandlerContext&, Reply reply) {
  const std::optional<int> number = sheet_number(request, reply);
  if (!number) return;
  const Answer<std::vector<SheetRecord>> sheets = service.jobs.sheets(request.params[0]);
  if (!sheets) return reply(problem_response(sheets.error(), request));
  const auto found = std::find_if(sheets->begin(), sheets->end(), [&](const SheetRecord& sheet) {
    return sheet.number == *number;
  });
  if (found == sheets->end())
    return reply(problem_response(
        Problem{ProblemKind::NotFound, fmt::format("the job has {} sheets; there is no sheet {}",
                                                   sheets->size(), *number)},
        request));
  reply(json_response(200, to_json(*found)));
}

void sheet_ledger(const Request& request, Service& service, const HandlerContext&, Reply reply) {
  const std::optional<int> number = sheet_number(request, reply);
  if (!number) return;
  const Answer<Ledger> ledger = service.jobs.ledger(request.params[0], *number);
  if (!ledger) return reply(problem_response(ledger.error(), request));
  reply(json_response(200, to_json(*ledger)));
}

void get_queue(const Request& request, Service& service, const HandlerContext&, Reply reply) {
  constexpr char kList = 'q';
  std::vector<RequestFault> faults;
  const PageRequest wanted = page_request(request, kList, faults, kUsualWhole);
  if (!faults.empty()) return reply(problem_response(validation(std::move(faults)), request));
  Answer<Page<Job>> page = service.jobs.queue(query_text(request, "device").value_or(""), wanted);
  if (!page) return reply(problem_response(page.error(), request));
  reply(page_response(std::move(*page), kList, [](const Job& job) { return job_text(job); }));
}

void hold_job(const Request& request, Service& service, const HandlerContext& context,
              Reply reply) {
  set_held(request, service, context, true, reply);
}

void release_job(const Request& request, Service& service, const HandlerContext& context,
                 Reply reply) {
  set_held(request, service, context, false, reply);
}

void move_job(const Request& request, Service& service, const HandlerContext& context,
              Reply reply) {
  struct Move {
    std::string job, before;
  };
  const auto wanted = read_body_as<Move>(request, context.limits.json_depth, [](Members& members) {
    Move move;
    move.job = read_job_id(members);
    move.before = members.text("before", 64).value_or("");
    return move;
  });
  if (!wanted) return reply(problem_response(wanted.error(), request));
  answer_once(request, service, reply, [&] {
    if (const auto stale = check_named(request, service, wanted->job))
      return problem_response(*stale, request);
    return answer_job(request, 200,
                      service.jobs.move(request.principal, wanted->job, wanted->before));
  });
}

}  // namespace popcut::daemon::http::handle
