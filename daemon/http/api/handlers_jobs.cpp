// SPDX-License-Identifier: MIT
#include <algorithm>

#include <fmt/format.h>

#include "daemon/http/api/handler_kit.hpp"
#include "daemon/http/api/handlers.hpp"
#include "daemon/http/api/input.hpp"
#include "daemon/http/api/render.hpp"

namespace popcut::daemon::http {
namespace {

constexpr InputRule kPriority = whole("priority", kLeastPriority, kMostPriority);
constexpr InputRule kJob = text("job", kIdLimit).required("must be the id of a job");

}  // namespace

const Body body::kJobCreate{
    .schema = "JobCreate",
    .fields =
        {text("design", kContentIdLimit).described("id of a design"),
         text("plan", kContentIdLimit).described("id of a plan"),
         text("material", kIdLimit)
             .described("default: the material of the design, else paper-220"),
         text("device", kIdLimit)
             .described("default: popcutd plans for the first cutter in /v1/devices that is "
                        "connected, and any cutter of that model can cut the job"),
         text_or_empty("site", kIdLimit)
             .described("only cutters at this site can cut the job; empty: any site"),
         plan_options("options"), whole("copies", 1, kMostCopies).by_default(1),
         kPriority.by_default(0), text_or_empty("name", kNameLimit), lines("note", kNoteLimit),
         texts("tags", kMostTags, kTagLimit).described("your own labels; popcutd only stores them"),
         word("on_sheet_done", "wait")
             .described("what popcutd does after a sheet: it waits until you arm the next "
                        "one")},
    .description = "Give either design or plan.",
    .example = R"({"design": "sha256-aa", "copies": 2, "name": "a card"})"};

const Body body::kJobPatch{
    .schema = "JobPatch",
    .fields = {kPriority, text_or_empty("name", kNameLimit), lines("note", kNoteLimit),
               text_or_empty("device", kIdLimit),
               text_or_empty("site", kIdLimit).described("empty: any site"),
               text("material", kIdLimit).described("needs plan_again"),
               flag("plan_again")
                   .by_default(0)
                   .described("make a new plan for the device and the material, with the same "
                              "options; possible while nothing of the job has been cut")},
    .description = "At least one member is required.",
    .example = R"({"priority": 3})",
    .least_fields = 1};

const Body body::kHold{
    .schema = "Hold", .fields = {kJob}, .example = R"({"job": "01JD0000000000000000000001"})"};

const Body body::kMove{
    .schema = "Move",
    .fields = {kJob, text("before", kIdLimit)
                         .described("id of a job of the same priority; default: after all other "
                                    "jobs of this priority")},
    .example = R"({"job": "01JD0000000000000000000001"})"};

namespace handle {
namespace {

JobCreate read_job(BodyReader& body) {
  FieldReader& fields = body.fields();
  JobCreate wanted;
  wanted.design = body.text("design");
  wanted.plan = body.text("plan");
  if (fields.has("design") == fields.has("plan"))
    fields.refuse(fields.has("plan") ? "plan" : "design", ErrorKind::Malformed,
                  "must be the only one: give a design or a plan", "one_of");
  wanted.material = body.text("material");
  wanted.device = body.text("device");
  wanted.site = body.text("site");
  wanted.options = body.options("options");
  wanted.copies = body.whole("copies");
  wanted.priority = body.whole("priority");
  wanted.name = body.text("name");
  wanted.note = body.text("note");
  wanted.tags = body.texts("tags");
  // No cutter feeds itself, so none can go on alone.
  static_cast<void>(body.optional_word("on_sheet_done"));
  return wanted;
}

JobPatch read_patch(BodyReader& body) {
  JobPatch patch;
  patch.priority = body.optional_whole("priority");
  patch.name = body.optional_text("name");
  patch.note = body.optional_text("note");
  patch.device = body.optional_text("device");
  patch.site = body.optional_text("site");
  patch.material = body.optional_text("material");
  patch.plan_again = body.flag("plan_again");
  return patch;
}

JobFilter read_filter(QueryReader& query) {
  JobFilter filter;
  filter.owner = query.text("owner");
  filter.device = query.text("device");
  filter.site = query.text("site");
  filter.since = query.time("since");
  filter.newest_first = query.word("order") == "desc";
  std::string states = query.text("state");
  while (!states.empty()) {
    const std::size_t comma = std::min(states.find(','), states.size());
    if (const auto state = job_state_from(states.substr(0, comma)))
      filter.states.push_back(*state);
    else
      query.refuse("state", "word",
                   "must be a comma-separated list of states: queued, planning, ready, armed, "
                   "cutting, paused, interrupted, done, failed, cancelled");
    if (query.problem()) break;
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

// Checks the job that a body names against If-Match, if there is one.
std::optional<Problem> check_named(const Request& request, Service& service,
                                   const std::string& id) {
  if (!request.header("if-match")) return std::nullopt;
  const Answer<Job> job = service.jobs.find(id);
  return job ? check_seen(request, *job) : job.error();
}

void set_held(const Request& request, Service& service, const HandlerContext& context, bool held,
              const Reply& reply) {
  const auto job = read_body<std::string>(request, context, body::kHold,
                                          [](BodyReader& body) { return body.text("job"); });
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
  const auto wanted = read_body<JobCreate>(request, context, body::kJobCreate, read_job);
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
  QueryReader query(request);
  const PageRequest wanted = query.page(kList);
  const JobFilter filter = read_filter(query);
  if (const auto wrong = query.problem()) return reply(problem_response(*wrong, request));
  Answer<Page<Job>> page = service.jobs.list(filter, wanted);
  if (!page) return reply(problem_response(page.error(), request));
  reply(page_response(std::move(*page), kList, [](const Job& job) { return job_text(job); }));
}

void get_job(const Request& request, Service& service, const HandlerContext&, Reply reply) {
  reply(answer_job(request, 200, service.jobs.find(request.params[0])));
}

void patch_job(const Request& request, Service& service, const HandlerContext& context,
               Reply reply) {
  const auto patch = read_body<JobPatch>(request, context, body::kJobPatch, read_patch);
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
  reply(done_response(request, service.jobs.remove(request.principal, job->id)));
}

void job_sheets(const Request& request, Service& service, const HandlerContext&, Reply reply) {
  constexpr char kList = 's';
  QueryReader query(request);
  const PageRequest wanted = query.page(kList);
  if (const auto wrong = query.problem()) return reply(problem_response(*wrong, request));
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
  QueryReader query(request);
  const PageRequest wanted = query.page(kList);
  if (const auto wrong = query.problem()) return reply(problem_response(*wrong, request));
  Answer<Page<Job>> page = service.jobs.queue(query.text("device"), wanted);
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
  const auto wanted = read_body<Move>(request, context, body::kMove, [](BodyReader& body) {
    Move move;
    move.job = body.text("job");
    move.before = body.text("before");
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

}  // namespace handle
}  // namespace popcut::daemon::http
