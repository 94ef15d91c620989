// SPDX-License-Identifier: MIT
#include "daemon/service/repositories/job_repository.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "daemon/model/input_limits.hpp"
#include "daemon/model/warnings.hpp"

namespace popcut::daemon {
namespace {

constexpr int kAtOnce = 200;  // jobs of one plan that change in one transaction
// A job has only so many warnings of so many bytes each, because lists show them; the plan has all.
constexpr std::size_t kWarningsOfJob = 10, kWarningOfJob = 300;

std::string priority_range() {
  return fmt::format("must be {}..{}", kLeastPriority, kMostPriority);
}

bool same_owner(const Principal& who, const JobRow& row) { return who.name == row.owner; }

}  // namespace

Answer<void> JobRepository::check(const JobCreate& request) const {
  Problem all{ProblemKind::Validation, "the job is not valid"};
  const auto add = [&](const std::string& pointer, const char* code, std::string advice) {
    all.errors.push_back({pointer, code, std::move(advice)});
  };
  const auto add_text = [&](const Answer<void>& fine) {
    if (!fine) all.errors.push_back(fine.error().errors.front());
  };
  if (request.design.empty() == request.plan.empty())
    add("/design", request.design.empty() ? "missing" : "value", "give either a design or a plan");
  if (!request.plan.empty() && !request.options.empty())
    add("/options", "value", "a plan already has its options; remove them");
  if (request.copies < 1 || request.copies > kMostCopies)
    add("/copies", "range", fmt::format("must be 1..{}", kMostCopies));
  if (request.priority < kLeastPriority || request.priority > kMostPriority)
    add("/priority", "range", priority_range());
  add_text(check_text(request.name, kNameLimit, "/name"));
  add_text(check_text(request.note, kNoteLimit, "/note", true));
  add_text(check_text(request.site, kIdLimit, "/site"));
  if (request.tags.size() > kMostTags)
    add("/tags", "range", fmt::format("must be at most {}", kMostTags));
  for (std::size_t i = 0; i < std::min(request.tags.size(), kMostTags); ++i)
    add_text(check_text(request.tags[i], kTagLimit, fmt::format("/tags/{}", i)));
  if (!request.device.empty() && !parts_.devices.find(request.device))
    all.errors.push_back(parts_.devices.unknown(request.device, "/device").errors.front());
  if (const std::string why = parts_.devices.wrong_site(request.device, request.site); !why.empty())
    add("/site", "value",
        fmt::format("{} {}; give its site or none, or another device", request.device, why));
  if (all.errors.empty()) return {};
  return tl::unexpected(std::move(all));
}

Answer<Job> JobRepository::create(const Principal& who, const JobCreate& request) {
  if (who.role < Role::Submitter)
    return refuse(ProblemKind::Forbidden, "creating a job requires the role submitter");
  if (const auto fine = check(request); !fine) return tl::unexpected(fine.error());
  return parts_.store.change([&]() -> Answer<Job> {
    if (const auto room = parts_.store.accepts_work(); !room) return tl::unexpected(room.error());
    if (request.plan.empty()) {
      const Answer<PlanRow> plan = parts_.plans.plan_for(who, {.design = request.design,
                                                               .material = request.material,
                                                               .device = request.device,
                                                               .machine = {},
                                                               .options = request.options,
                                                               .site = request.site});
      if (!plan) return tl::unexpected(plan.error());
      return add(who, request, *plan);
    }
    const auto plan = parts_.plans.table().find(request.plan);
    if (!plan) return refuse_value("/plan", "unknown", "must be the id of a plan");
    if (plan->state == PlanState::Failed)
      return refuse_value("/plan", "value", "this plan failed: " + plan->error);
    if (!request.material.empty() && request.material != plan->material)
      return refuse_value("/material", "value", "this plan is for " + plan->material);
    return add(who, request, *plan);
  });
}

Answer<Job> JobRepository::create_test(const Principal& who, const std::string& device,
                                       const std::string& material) {
  return parts_.store.change([&]() -> Answer<Job> {
    if (const auto room = parts_.store.accepts_work(); !room) return tl::unexpected(room.error());
    const Answer<PlanRow> plan = parts_.plans.test_plan_for(who, device, material);
    if (!plan) return tl::unexpected(plan.error());
    JobCreate request;
    request.device = device;
    request.name = "test cut";
    request.priority = 10;
    return add(who, request, *plan);
  });
}

Answer<Job> JobRepository::add(const Principal& who, const JobCreate& request,
                               const PlanRow& plan) {
  ServiceStore& store = parts_.store;
  if (jobs_.open_count() >= parts_.options.queue_jobs) {
    return refuse(ProblemKind::QueueFull,
                  fmt::format("the queue is full ({} jobs); finish or cancel some first",
                              parts_.options.queue_jobs),
                  /*retry_after_s=*/60);
  }
  if (const std::int64_t own = jobs_.open_count_of(who.name); own >= parts_.options.jobs_each)
    return refuse(
        ProblemKind::QueueFull,
        fmt::format("{} jobs of yours are not finished; finish or cancel some first", own),
        /*retry_after_s=*/60);
  if (const auto waits = parts_.plans.add_waiting(who, plan); !waits)
    return tl::unexpected(waits.error());
  const TimeMs created = store.now();
  JobRow row{.id = store.new_id(created), .rev = 1, .state = JobState::Queued};
  row.name = request.name;
  row.note = request.note;
  row.owner = who.name;
  row.requested_device = request.device;
  row.site = request.site;
  row.design = plan.design;
  row.plan = plan.id;
  row.material = plan.material;
  row.priority = request.priority;
  row.position = jobs_.last_position() + kPositionStep;
  row.copies = request.copies;
  row.created = created;
  row.tags = request.tags;
  const std::int64_t sheets = std::int64_t{plan.sheets} * request.copies;
  if (plan.state == PlanState::Planned && sheets > parts_.options.sheets_per_job)
    return refuse_value("/copies", "range",
                        fmt::format("{} copies make {} sheets; a job has at most {}",
                                    request.copies, sheets, parts_.options.sheets_per_job));
  // Until the plan is made its area is 0, so `misfit` does not compare areas.
  if (!request.device.empty())
    if (const std::string why = parts_.devices.misfit(request.device, plan, row.site); !why.empty())
      return refuse_value("/device", "value", why);
  if (request.device.empty() && request.plan.empty())
    row.warnings = choice_warnings(plan.material, row.site);
  jobs_.insert(row);
  store.audit(who.name, "create-job", row.id, row.name);
  if (plan.state == PlanState::Planned) {
    apply_plan(row, plan);
  } else {
    store.emit("job", row.id, JsonObject().text("state", "queued").number("rev", row.rev));
    store.after_commit([this] { parts_.plans.pump(); });
  }
  return shown(row);
}

void JobRepository::apply_plan(JobRow& row, const PlanRow& plan) {
  const std::int64_t sheets = std::int64_t{plan.sheets} * row.copies;
  if (plan.state == PlanState::Failed)
    return apply(row, step_of(row.state, JobEvent::PlanFails), plan.error);
  if (sheets > parts_.options.sheets_per_job)
    return apply(row, step_of(row.state, JobEvent::PlanFails),
                 fmt::format("{} copies make {} sheets; a job has at most {}", row.copies, sheets,
                             parts_.options.sheets_per_job));
  row.sheets_total = static_cast<int>(sheets);
  row.sheet = 1;
  row.paths_total = plan.paths * row.copies;
  row.low_s = plan.low_s * row.copies;
  row.high_s = plan.high_s * row.copies;
  row.handwork = plan.handwork;
  row.unaccepted = spoiling_codes(plan.warnings);
  // Warnings of the job itself come first.
  row.warnings.insert(row.warnings.end(), plan.warnings.begin(), plan.warnings.end());
  shorten(row.warnings, kWarningsOfJob, kWarningOfJob);
  apply(row, step_of(row.state, JobEvent::PlanComes), "");
}

void JobRepository::plan_begun(const std::string& plan) {
  (void)parts_.store.change([&]() -> Answer<void> {
    for (JobRow& row : jobs_.waiting_for(plan, JobState::Queued, kAtOnce))
      apply(row, step_of(row.state, JobEvent::PlanBegins), "");
    return {};
  });
}

void JobRepository::plan_progressed(const std::string& plan, const PlanningPhase& phase) {
  constexpr int kMostPublished = 20;  // jobs of one plan
  (void)parts_.store.read([&]() -> Answer<void> {
    for (const JobRow& row : jobs_.waiting_for(plan, JobState::Planning, kMostPublished)) {
      JsonObject data;
      data.number("seq", 0)
          .text("kind", "progress")
          .text("job", row.id)
          .text("state", name_of(row.state))
          .number("rev", row.rev)
          .text("phase", phase.phase)
          .text("doing", phase.doing);
      if (phase.done < 0)
        data.null("share");
      else
        data.number("share", phase.done, 2);
      parts_.store.publish({.seq = 0,
                            .kind = "progress",
                            .time = parts_.store.now(),
                            .job = row.id,
                            .data = data.whole()});
    }
    return {};
  });
}

void JobRepository::plans_ended_before() {
  for (const std::string& plan :
       all_of(parts_.store.db().rows("SELECT DISTINCT job.plan FROM job JOIN plan ON "
                                     "plan.id=job.plan WHERE job.state='queued' AND "
                                     "plan.state!='pending'"),
              first_text))
    plan_ended(plan);
}

void JobRepository::plan_ended(const std::string& id) {
  bool more = false;
  const Answer<void> stored = parts_.store.change([&]() -> Answer<void> {
    const auto plan = parts_.plans.table().find(id);
    if (!plan || plan->state == PlanState::Pending) return {};
    for (const JobState state : {JobState::Planning, JobState::Queued}) {
      std::vector<JobRow> rows = jobs_.waiting_for(id, state, kAtOnce);
      for (JobRow& row : rows) apply_plan(row, *plan);
      more = more || rows.size() == kAtOnce;
    }
    return {};
  });
  // If the disk is full, `catch_up` tries again later.
  if (stored)
    left_over_.erase(id);
  else
    left_over_.insert(id);
  // Update the rest in another turn, so that a running cut does not wait long.
  if (stored && more) parts_.post([this, id] { plan_ended(id); });
}

void JobRepository::catch_up() {
  const std::set<std::string> plans = left_over_;
  for (const std::string& plan : plans) plan_ended(plan);
}

Answer<JobRow> JobRepository::row(const std::string& id) {
  if (auto found = jobs_.find(id)) return std::move(*found);
  return refuse(ProblemKind::NotFound, fmt::format("there is no job {:?}", id));
}

void JobRepository::put_sheet(const JobRow& row, std::string_view state,
                              std::optional<TimeMs> finished) {
  std::optional<TimeMs> started;
  if (state == "cutting") started = parts_.store.now();
  attempts_.put_sheet(row.id, row.sheet, row.blank, row.segment, state, started, finished);
}

void JobRepository::set_attention(JobRow& row, const std::string& kind,
                                  const std::string& text) const {
  row.attention_kind = kind;
  row.attention_text = text;
  row.attention_since = kind.empty() ? 0 : parts_.store.now();
}

// What a person must load into the cutter for the current sheet.
std::optional<LoadedSheet> JobRepository::load_of(const JobRow& row) {
  const auto sheet = current_sheet(row);
  const auto plan = parts_.plans.table().find(row.plan);
  if (!sheet || !plan) return std::nullopt;
  return LoadedSheet{.material = plan->material,
                     .machine = plan->machine,
                     .mat = sheet->mat,
                     .width_mm = sheet->area_mm[0],
                     .length_mm = sheet->area_mm[1],
                     .side = sheet->side};
}

void JobRepository::apply(JobRow& row, Step step, const std::string& reason) {
  if (step == Step::Refused)
    throw StoreFault(FaultKind::Other, fmt::format("job {} cannot do this while it is {}", row.id,
                                                   name_of(row.state)));
  if (step == Step::NextSheet) return finish_sheet(row, "done", reason);
  const JobState before = row.state;
  row.state = state_after(before, step, row.sheet, row.sheets_total);
  row.reason = reason;
  row.asked.clear();
  switch (row.state) {
    case JobState::Ready:
      set_attention(
          row, "load_sheet",
          row.segment > 1
              ? fmt::format("leave sheet {} of {} in place; the cut continues from path {}",
                            row.sheet, row.sheets_total, row.first_stroke)
              : fmt::format("load sheet {} of {}", row.sheet, row.sheets_total));
      row.device.clear();
      row.load = load_of(row);
      put_sheet(row, "ready");
      break;
    case JobState::Armed:
      set_attention(row, "", "");
      put_sheet(row, "armed");
      break;
    case JobState::Cutting:
      set_attention(row, "", "");
      if (!row.started) row.started = parts_.store.now();
      put_sheet(row, "cutting");
      break;
    case JobState::Interrupted:
      put_sheet(row, "interrupted");
      break;
    case JobState::Done:
    case JobState::Failed:
    case JobState::Cancelled:
      end_job(row);
      if (before == JobState::Cutting || before == JobState::Paused) put_sheet(row, "interrupted");
      if (before == JobState::Armed) put_sheet(row, "ready");
      break;
    default:
      break;
  }
  save(row);
}

void JobRepository::disarm(const std::string& job) {
  attempts_.disarm(job);
  parts_.store.after_commit([this, job] {
    if (disarmed) disarmed(job);
  });
}

void JobRepository::apply_or_cancel(JobRow& row, Step step, const std::string& reason) {
  const bool is_cancelled = parts_.store.in_fleet() && row.asked == "cancel" &&
                            (step == Step::ToInterrupted || step == Step::ToReady);
  if (is_cancelled)
    apply(row, Step::ToCancelled, row.reason);
  else
    apply(row, step, reason);
}

void JobRepository::save(JobRow& row) {
  jobs_.update(row);
  JsonObject members;
  members.text("state", name_of(row.state)).number("rev", row.rev);
  if (!row.reason.empty()) members.text("reason", row.reason);
  if (row.sheet > 0) members.number("sheet", row.sheet).number("sheets_total", row.sheets_total);
  if (!row.attention_kind.empty()) members.text("attention", row.attention_kind);
  parts_.store.emit("job", row.id, members);
}

void JobRepository::finish_sheet(JobRow& row, const std::string& sheet_state,
                                 const std::string& reason) {
  const auto plan = current_sheet(row);
  put_sheet(row, sheet_state, parts_.store.now());
  parts_.store.emit("sheet", row.id,
                    JsonObject()
                        .number("sheet", row.sheet)
                        .number("blank", row.blank)
                        .text("state", sheet_state)
                        .number("rev", row.rev + 1));
  if (plan) {
    if (sheet_state == "done") {
      row.done_paths += plan->paths;
      row.done_mm += plan->cut_mm + plan->fold_mm;
    }
    row.low_s = std::max(0.0, row.low_s - plan->seconds_range[0]);
    row.high_s = std::max(0.0, row.high_s - plan->seconds_range[1]);
  }
  if (sheet_state == "skipped" && row.outcome.empty()) row.outcome = "done with skipped sheets";
  row.paths_certain = row.paths_sent = 0;
  const JobState next = state_after(row.state, Step::NextSheet, row.sheet, row.sheets_total);
  if (next == JobState::Ready) {
    ++row.sheet;
    row.blank = row.segment = 1;
    row.first_stroke = 0;
    // If the database went back to an earlier state, and a journal restored a START of this sheet,
    // it may be cut already.
    if (const auto begun = attempts_.last_begun(row.id, row.sheet)) {
      row.blank = begun->blank;
      row.segment = begun->segment;
      row.first_stroke = begun->first_stroke;
      set_attention(row, "in_doubt",
                    fmt::format("sheet {} was started before; look at it", row.sheet));
      return apply(row, Step::ToInterrupted, "crash");
    }
    return apply(row, Step::ToReady, reason);
  }
  row.low_s = row.high_s = 0;
  row.state = JobState::Done;
  row.reason = reason;
  row.asked.clear();
  end_job(row);
  save(row);
}

void JobRepository::end_job(JobRow& row) const {
  set_attention(row, "", "");
  row.finished = parts_.store.now();
  if (row.outcome.empty()) row.outcome = name_of(row.state);
}

void JobRepository::count_paths(JobRow& row, int sheet, int blank, std::int64_t strokes) {
  std::vector<std::vector<FateRun>> fates;
  for (const AttemptRow& attempt : attempts_.of_sheet(row.id, sheet))
    if (attempt.blank == blank) fates.push_back(attempts_.fates(attempt.id));
  row.paths_certain = row.paths_sent = 0;
  for (const FateRun& run : merged_fates(strokes, fates)) {
    const std::int64_t count = run.paths.last - run.paths.first + 1;
    if (run.fate == PathFate::Certain) row.paths_certain += count;
    if (run.fate != PathFate::NotSent) row.paths_sent += count;
  }
}

std::optional<SheetPlan> JobRepository::current_sheet(const JobRow& row) {
  if (row.sheet == 0) return std::nullopt;
  const int plan_sheets = row.sheets_total / std::max(1, row.copies);
  return parts_.plans.table().sheet(row.plan, plan_sheet(row, row.sheet, plan_sheets));
}

// After a change, the device of a job must be at the site of the job.
Answer<void> JobRepository::check_site(const JobRow& row, const JobPatch& request) const {
  if (!request.site && !request.device) return {};
  const std::string device = request.device.value_or(row.requested_device);
  const std::string why = parts_.devices.wrong_site(device, request.site.value_or(row.site));
  if (why.empty()) return {};
  Problem problem =
      invalid_value(request.site ? "/site" : "/device", "value", fmt::format("{} {}", device, why));
  JobRow there = row;
  there.requested_device = device;
  if (!request.site)
    problem.next_actions = {change_action(there, device, request.plan_again)};
  else if (row.segment == 1)
    problem.next_actions = {
        {"change",
         JobPatch{.device = "", .site = *request.site, .plan_again = request.plan_again}}};
  return tl::unexpected(std::move(problem));
}

Answer<Job> JobRepository::patch(const Principal& who, const std::string& id, std::int64_t if_match,
                                 const JobPatch& request) {
  return parts_.store.change([&]() -> Answer<Job> {
    Answer<JobRow> row = this->row(id);
    if (!row) return tl::unexpected(row.error());
    if (who.role < Role::Operator && !(who.role == Role::Submitter && same_owner(who, *row)))
      return refuse(ProblemKind::Forbidden, "only an operator may change someone else's job");
    if (const auto fresh = check_rev(*row, if_match); !fresh) return tl::unexpected(fresh.error());
    if (row->state != JobState::Queued && row->state != JobState::Planning &&
        row->state != JobState::Ready)
      return refused(
          *row, conflict(*row, "a job can be changed only while it is queued, planning or ready"));
    if (request.priority &&
        (*request.priority < kLeastPriority || *request.priority > kMostPriority))
      return refuse_value("/priority", "range", priority_range());
    if (request.name)
      if (const auto fine = check_text(*request.name, kNameLimit, "/name"); !fine)
        return tl::unexpected(fine.error());
    if (request.note)
      if (const auto fine = check_text(*request.note, kNoteLimit, "/note", true); !fine)
        return tl::unexpected(fine.error());
    if (request.site)
      if (const auto fine = check_text(*request.site, kIdLimit, "/site"); !fine)
        return tl::unexpected(fine.error());
    if (request.material && !request.plan_again)
      return refuse_value("/material", "value",
                          "needs plan_again: true, because another material needs "
                          "another plan");
    if (request.device && !request.device->empty()) {
      const auto with_others = [&](Problem problem) {
        problem.next_actions = other_devices(*row);
        return tl::unexpected(std::move(problem));
      };
      if (!parts_.devices.find(*request.device))
        return with_others(parts_.devices.unknown(*request.device, "/device"));
      const auto plan = parts_.plans.table().find(row->plan);
      if (row->segment > 1 && *request.device != row->requested_device)
        return refused(*row, conflict(*row, "this sheet is in " + row->requested_device));
      if (const std::string why =
              plan && !request.plan_again ? parts_.devices.misfit(*request.device, *plan, "") : "";
          !why.empty()) {
        Problem problem = invalid_value("/device", "value", why);
        problem.next_actions = other_devices(*row);
        if (auto action = plan_again_action(*row, *request.device, *plan))
          problem.next_actions.insert(problem.next_actions.begin(), std::move(*action));
        return tl::unexpected(std::move(problem));
      }
    }
    if (const auto agrees = check_site(*row, request); !agrees)
      return tl::unexpected(agrees.error());
    row->site = request.site.value_or(row->site);
    row->priority = request.priority.value_or(row->priority);
    row->name = request.name.value_or(row->name);
    row->note = request.note.value_or(row->note);
    row->requested_device = request.device.value_or(row->requested_device);
    if (!request.plan_again)
      save(*row);
    else if (const auto planned = plan_again(who, *row, request); !planned)
      return tl::unexpected(planned.error());
    parts_.store.audit(who.name, "patch-job", id, "");
    return shown(*row);
  });
}

Answer<void> JobRepository::remove(const Principal& who, const std::string& id) {
  return parts_.store.change([&]() -> Answer<void> {
    const Answer<JobRow> row = this->row(id);
    if (!row) return tl::unexpected(row.error());
    if (who.role < Role::Operator && !same_owner(who, *row))
      return refuse(ProblemKind::Forbidden, "only an operator may delete someone else's job");
    if (!is_terminal(row->state))
      return refuse_state(*row, "only a finished job can be deleted; cancel it first");
    parts_.store.db().run("UPDATE job SET deleted=1, rev=rev+1 WHERE id=?", id);
    parts_.store.audit(who.name, "delete-job", id, row->name);
    parts_.store.emit("job", id,
                      JsonObject()
                          .text("state", name_of(row->state))
                          .number("rev", row->rev + 1)
                          .flag("deleted", true));
    return {};
  });
}

Answer<Job> JobRepository::hold(const Principal& who, const std::string& id, bool held) {
  return parts_.store.change([&]() -> Answer<Job> {
    Answer<JobRow> row = this->row(id);
    if (!row) return tl::unexpected(row.error());
    if (who.role < Role::Operator && !(who.role == Role::Submitter && same_owner(who, *row)))
      return refuse(ProblemKind::Forbidden,
                    "only an operator may hold or release someone else's job");
    if (is_terminal(row->state) || row->state == JobState::Cutting ||
        row->state == JobState::Paused)
      return refused(*row, conflict(*row, "only a waiting job can be held or released"));
    if (row->held == held) return shown(*row);
    row->held = held;
    if (held && row->state == JobState::Armed) {
      disarm(id);
      apply(*row, Step::ToReady, "held");
    } else {
      save(*row);
    }
    parts_.store.audit(who.name, held ? "hold" : "release", id, "");
    parts_.store.emit("queue", id, JsonObject().flag("held", held).number("rev", row->rev));
    return shown(*row);
  });
}

Answer<Job> JobRepository::move(const Principal& who, const std::string& id,
                                const std::string& before) {
  if (who.role < Role::Operator)
    return refuse(ProblemKind::Forbidden, "only an operator may reorder the queue");
  return parts_.store.change([&]() -> Answer<Job> {
    Answer<JobRow> row = this->row(id);
    if (!row) return tl::unexpected(row.error());
    if (is_terminal(row->state)) return refuse_state(*row, "this job has ended");
    if (before.empty()) {
      row->position = jobs_.last_position() + kPositionStep;
    } else {
      if (before == id)
        return refuse_value("/before", "value", "must not be the job that is moved");
      const Answer<JobRow> next = this->row(before);
      if (!next) return refuse_value("/before", "unknown", "must be the id of a job");
      if (next->priority != row->priority || is_terminal(next->state))
        return refuse_value("/before", "value", "must be a waiting job with the same priority");
      const auto place = jobs_.make_room(*next, id);
      if (!place)
        return refuse_state(*row,
                            "too many jobs were moved here; choose another place for this job");
      row->position = *place;
    }
    save(*row);
    parts_.store.audit(who.name, "move", id, before);
    parts_.store.emit("queue", id, JsonObject().flag("moved", true).number("rev", row->rev));
    return shown(*row);
  });
}

}  // namespace popcut::daemon
