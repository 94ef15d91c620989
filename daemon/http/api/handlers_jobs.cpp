// SPDX-License-Identifier: MIT
#include <algorithm>

#include <fmt/format.h>

#include "daemon/http/api/handler_kit.hpp"
#include "daemon/http/api/handlers.hpp"
#include "daemon/http/api/json_body.hpp"
#include "daemon/http/api/render.hpp"

namespace popcut::daemon::http::handle {
namespace {

JobCreate read_job(FieldReader& fields) {
  JobCreate wanted;
  wanted.design = fields.text("design", "", line(80));
  wanted.plan = fields.text("plan", "", line(80));
  if (fields.has("design") == fields.has("plan"))
    fields.refuse(fields.has("plan") ? "plan" : "design", ErrorKind::Malformed,
                  "must be the only one: give a design or a plan", "one_of");
  wanted.material = fields.text("material", "", line(64));
  wanted.device = fields.text("device", "", line(64));
  wanted.site = fields.text("site", "", line_or_empty(64));
  wanted.options = read_options(fields, "options");
  wanted.copies = fields.integer("copies", 1, 1, 1000);
  wanted.priority = fields.integer("priority", 0, -10, 10);
  wanted.name = fields.text("name", "", line_or_empty(120));
  wanted.note = fields.text("note", "", lines_or_empty(2000));
  wanted.tags = fields.optional_texts("tags", 20, line(40)).value_or(std::vector<std::string>());
  // No cutter feeds itself so that it could go on alone.
  fields.word("on_sheet_done", 0, {"wait"});
  return wanted;
}

JobPatch read_patch(FieldReader& fields) {
  JobPatch patch;
  if (const auto priority = fields.optional_integer("priority", -10, 10))
    patch.priority = static_cast<int>(*priority);
  patch.name = fields.optional_text("name", line_or_empty(120));
  patch.note = fields.optional_text("note", lines_or_empty(2000));
  patch.device = fields.optional_text("device", line_or_empty(64));
  patch.site = fields.optional_text("site", line_or_empty(64));
  patch.material = fields.optional_text("material", line(64));
  patch.plan_again = fields.boolean("plan_again", false);
  return patch;
}

JobFilter read_filter(const Request& request, std::vector<RequestFault>& faults) {
  JobFilter filter;
  filter.owner = query_text(request, "owner").value_or("");
  filter.device = query_text(request, "device").value_or("");
  filter.site = query_text(request, "site").value_or("");
  filter.since = query_time(request, "since", faults);
  const std::string order = query_text(request, "order").value_or("asc");
  filter.newest_first = order == "desc";
  if (order != "asc" && order != "desc")
    faults.push_back({"?order", "word", "must be asc (the oldest first) or desc"});
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

std::string read_job_id(FieldReader& fields) {
  fields.need("job", "must be the id of a job");
  return fields.text("job", "", line(64));
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
  if (!patch->priority && !patch->name && !patch->note && !patch->device && !patch->site &&
      !patch->material && !patch->plan_again)
    return reply(problem_response(
        validation({{"", "empty",
                     "must contain at least one of priority, name, note, device, site, material, "
                     "plan_again"}}),
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
  const int after = path_number(wanted.cursor).value_or(0);
  Answer<std::vector<SheetRecord>> sheets =
      service.jobs.sheets(request.params[0], after + 1, wanted.limit + 1);
  if (!sheets) return reply(problem_response(sheets.error(), request));
  reply(
      page_response(page_of(std::move(*sheets), {wanted.limit, {}},
                            [](const SheetRecord& sheet) { return std::to_string(sheet.number); }),
                    kList, [](const SheetRecord& sheet) { return dump(to_json(sheet)); }));
}

void job_sheet(const Request& request, Service& service, const HandlerContext&, Reply reply) {
  const std::optional<int> number = sheet_number(request, reply);
  if (!number) return;
  const Answer<Job> job = service.jobs.find(request.params[0]);
  if (!job) return reply(problem_response(job.error(), request));
  const Answer<std::vector<SheetRecord>> sheets = service.jobs.sheets(job->id, *number, 1);
  if (!sheets) return reply(problem_response(sheets.error(), request));
  if (sheets->empty())
    return reply(problem_response(
        Problem{ProblemKind::NotFound, fmt::format("the job has {} sheets; there is no sheet {}",
                                                   job->sheets_total, *number)},
        request));
  reply(json_response(200, to_json(sheets->front())));
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
  const auto wanted =
      read_body_as<Move>(request, context.limits.json_depth, [](FieldReader& fields) {
        Move move;
        move.job = read_job_id(fields);
        move.before = fields.text("before", "", line(64));
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
