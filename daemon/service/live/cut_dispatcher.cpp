// SPDX-License-Identifier: MIT
#include "daemon/service/live/cut_dispatcher.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "daemon/model/input_limits.hpp"
#include "daemon/model/warnings.hpp"
#include "daemon/service/live/running_cut.hpp"
#include "daemon/service/repositories/recovery.hpp"
#include "daemon/service/repositories/reports.hpp"

namespace popcut::daemon {
namespace {

bool needs_sheet(JobAction action) {
  return action == JobAction::Arm || action == JobAction::ConfirmResult ||
         action == JobAction::RetrySheet || action == JobAction::SkipSheet;
}

std::string audit_detail(const ActionRequest& request, const JobRow& row) {
  std::string detail =
      fmt::format("sheet {} blank {} segment {}", row.sheet, row.blank, row.segment);
  if (!row.device.empty()) detail += " on " + row.device;
  if (request.good) detail += *request.good ? " good" : " not good";
  if (request.from_path)
    detail +=
        fmt::format(" from path {}, registration {}{}{}", *request.from_path, request.registration,
                    request.accept_double_cut ? ", double cut accepted" : "",
                    request.skip_in_doubt ? ", doubt skipped" : "");
  if (!request.accept_warnings.empty())
    detail += fmt::format(", accepted: {}", fmt::join(request.accept_warnings, " "));
  if (!request.reason.empty()) detail += ": " + request.reason;
  return detail;
}

// Why those that are there cannot cut a plan: " (sim:a: it is set up for ...)"; empty: none is.
std::string why_none(const DeviceRegistry& devices, const PlanRow& plan, const std::string& site) {
  constexpr std::size_t kMost = 3;
  std::vector<std::string> reasons;
  for (const DeviceRecord& device : devices.list())
    if (reasons.size() < kMost && devices.usable(device.id))
      reasons.push_back(fmt::format("{}: {}", device.id, devices.misfit(device.id, plan, site)));
  return reasons.empty() ? std::string() : fmt::format(" ({})", fmt::join(reasons, "; "));
}

}  // namespace

Answer<void> CutDispatcher::check_words(const JobRow& row, const ActionRequest& request) const {
  if (needs_sheet(request.action) && !request.sheet)
    return tl::unexpected(invalid_value("/sheet", "missing", fmt::format("must be {}", row.sheet)));
  if (const auto fine = check_text(request.reason, kReasonLimit, "/reason"); !fine)
    return tl::unexpected(fine.error());
  if (request.action == JobAction::ConfirmResult && !request.good)
    return tl::unexpected(invalid_value("/good", "missing", "must be true or false"));
  if (request.action != JobAction::ResumeFrom) return {};
  if (!request.from_path)
    return tl::unexpected(invalid_value("/from_path", "missing", "must be a path"));
  if (request.registration != "kept" && request.registration != "re-registered")
    return tl::unexpected(invalid_value("/registration",
                                        request.registration.empty() ? "missing" : "value",
                                        "must be \"kept\" or \"re-registered\""));
  return {};
}

Answer<Job> CutDispatcher::act(const Principal& who, const std::string& id, std::int64_t if_match,
                               const ActionRequest& request) {
  JobRepository& jobs = parts_.jobs;
  const bool to_the_knife =
      request.action == JobAction::Pause || request.action == JobAction::Cancel;
  try {
    // Not const: it is moved out, since a copy of an Answer ends the program without memory.
    Answer<Job> done = parts_.store.change([&]() -> Answer<Job> {
      Answer<JobRow> found = jobs.row(id);
      if (!found) return tl::unexpected(found.error());
      JobRow& row = *found;
      const Role needed = role_for(request.action, row.owner == who.name);
      if (who.role < needed)
        return refuse(
            ProblemKind::Forbidden,
            fmt::format("{} requires the role {}", name_of(request.action), name_of(needed)));
      if (const auto fresh = JobRepository::check_rev(row, if_match); !fresh)
        return tl::unexpected(fresh.error());
      const JobRow before = row;
      // Whoever is refused learns the whole request that is not.
      const auto refused = [&](Problem problem) {
        const bool writes = !parts_.store.degraded() && !stopping_;
        if (problem.ways.empty() && writes) problem.ways = ways(before, &request);
        return tl::unexpected(std::move(problem));
      };
      if (step_of(JobRepository::facts_of(row), request.action) == Step::Refused)
        return refused(JobRepository::conflict(
            row, fmt::format("{} is not possible while the job is {}{}", name_of(request.action),
                             row.held ? "held and " : "", name_of(row.state))));
      if (const auto fine = check_words(row, request); !fine) return refused(fine.error());
      if (request.sheet && *request.sheet != row.sheet)
        return refused(JobRepository::conflict(
            row, fmt::format("the current sheet is {}, not {}", row.sheet, *request.sheet)));
      if (request.blank && *request.blank != row.blank)
        return refused(JobRepository::conflict(
            row, fmt::format("the current blank is {}, not {}", row.blank, *request.blank)));
      const std::string detail = audit_detail(request, row);
      const Answer<void> taken = [&]() -> Answer<void> {
        switch (request.action) {
          case JobAction::Arm:
            return arm(who, row, request);
          case JobAction::Disarm:
            jobs.attempts().disarm(id);
            parts_.programs.forget(id);
            jobs.take(row, Step::ToReady, "disarmed");
            return {};
          case JobAction::Start:
            return start(who, row, request);
          case JobAction::Pause:
            return pause(row);
          case JobAction::Resume:
            return resume(row);
          case JobAction::Cancel:
            return cancel(who, row, request);
          case JobAction::ConfirmResult:
            return confirm(row, request);
          case JobAction::RetrySheet:
            return retry(row);
          case JobAction::SkipSheet:
            jobs.finish_sheet(row, "skipped", "skipped");
            return {};
          case JobAction::ResumeFrom:
            return resume_from(row, request);
        }
        return {};
      }();
      if (!taken) return refused(taken.error());
      parts_.store.audit(who.name, name_of(request.action), id, detail);
      return jobs.shown(row);
    });
    const bool unwritten = !done && (done.error().kind == ProblemKind::DiskFull ||
                                     done.error().kind == ProblemKind::Unavailable);
    if (unwritten && to_the_knife) stop_unrecorded(who, id, request.action);
    return done;
  } catch (const StoreFault&) {
    if (to_the_knife) stop_unrecorded(who, id, request.action);
    throw;
  }
}

// Pausing and stopping are safe at any time, so they do not wait for the disk.
void CutDispatcher::stop_unrecorded(const Principal& who, const std::string& id, JobAction action) {
  const auto found = cuts_.find(id);
  if (found == cuts_.end() || who.role < role_for(action, found->second->owner == who.name)) return;
  if (action == JobAction::Pause) {
    found->second->pause_asked = true;
    parts_.cutters.pause(found->second->device);
  } else {
    found->second->cancel_asked = true;
    parts_.cutters.cancel(found->second->device);
  }
}

Answer<std::string> CutDispatcher::choose_device(const JobRow& row, const ActionRequest& request,
                                                 const PlanRow& plan) const {
  const DeviceRegistry& devices = parts_.devices;
  if (!request.device.empty() && !row.requested_device.empty() &&
      request.device != row.requested_device)
    return tl::unexpected(JobRepository::conflict(
        row,
        fmt::format("the job is for {}, not for {}{}", row.requested_device, request.device,
                    row.segment > 1 ? ", which holds its sheet" : "; change its device first")));
  std::string device = request.device.empty() ? row.requested_device : request.device;
  if (!device.empty()) {
    if (!devices.find(device)) return tl::unexpected(devices.unknown(device, "/device"));
    if (const auto fine = devices.usable(device); !fine) return tl::unexpected(fine.error());
    if (const std::string why = devices.wrong_site(device, row.site); !why.empty())
      return tl::unexpected(
          JobRepository::conflict(row, fmt::format("{} {}; change its site first", device, why)));
    if (const std::string why = devices.misfit(device, plan, row.site); !why.empty())
      return tl::unexpected(
          JobRepository::conflict(row, fmt::format("{} cannot cut this: {}", device, why)));
    return device;
  }
  std::vector<std::string> fitting = devices.fitting(plan, row.site);
  if (fitting.empty())
    return refuse(
        ProblemKind::DeviceAbsent,
        fmt::format("no {} is available that can cut this; plug one in and switch it on{}",
                    plan.machine, why_none(devices, plan, row.site)));
  if (fitting.size() > 1)
    std::erase_if(fitting, [&](const std::string& id) {
      return parts_.jobs.table().on_device(id).has_value();
    });
  if (fitting.size() == 1) return fitting.front();
  Problem unnamed = invalid_value(
      "/device", "missing",
      fitting.empty()
          ? std::string("all suitable devices are busy; wait until one is free")
          : fmt::format("name the device that holds the sheet: {}", fmt::join(fitting, ", ")));
  for (const std::string& one : fitting)
    unnamed.ways.push_back(
        {"arm", fmt::format(R"({{"sheet":{},"blank":{},"device":{}{}}})", row.sheet, row.blank,
                            json_text(one), accepting(row))});
  return tl::unexpected(std::move(unnamed));
}

Answer<void> CutDispatcher::arm(const Principal& who, JobRow& row, const ActionRequest& request) {
  if (const auto sound = parts_.store.accepts_arming(); !sound)
    return tl::unexpected(sound.error());
  if (may_cut)
    if (const auto may = may_cut(); !may) return tl::unexpected(may.error());
  const auto plan = parts_.plans.table().find(row.plan);
  if (!plan || plan->state != PlanState::Planned)
    return tl::unexpected(
        JobRepository::conflict(row, "the job's plan is gone; create the job again"));
  if (!request.plan_sha256.empty() && request.plan_sha256 != plan->sha256)
    return tl::unexpected(JobRepository::conflict(
        row, "the plan is " + plan->sha256 + ", not the one in the request"));
  if (const auto sheet = parts_.jobs.current_sheet(row); !sheet || sheet->index_sha256.empty())
    return tl::unexpected(JobRepository::conflict(
        row,
        "an earlier popcutd made this job's plan and did not protect it from changes; create the "
        "job again"));
  if (const std::string why = parts_.intents.why_blocked(row.id); !why.empty())
    return tl::unexpected(JobRepository::conflict(row, why));
  const Answer<std::string> device = choose_device(row, request, *plan);
  if (!device) return tl::unexpected(device.error());
  if (const auto known = check_place(row, *device); !known) return tl::unexpected(known.error());
  if (const auto other = parts_.jobs.table().on_device(*device))
    return tl::unexpected(JobRepository::conflict(
        row,
        fmt::format("{} holds a sheet of job {} ({})", *device, other->id, name_of(other->state))));
  if (const auto accepted = accept_warnings(row, request); !accepted)
    return tl::unexpected(accepted.error());
  if (const auto sheet = parts_.jobs.current_sheet(row))
    if (const auto here = parts_.plans.bring_sheet(row.plan, sheet->number); !here)
      return tl::unexpected(here.error());
  if (const auto asked = asked_from_.find(row.id); asked != asked_from_.end() &&
                                                   asked->second.segment == row.segment &&
                                                   asked->second.first_stroke != row.first_stroke)
    return tl::unexpected(JobRepository::conflict(
        row,
        fmt::format("this sheet would go on from path {}, but a person asked here for path {}; "
                    "use a new blank with retry-sheet",
                    row.first_stroke, asked->second.first_stroke)));
  row.device = *device;
  row.operator_name = who.name;
  parts_.jobs.take(row, Step::ToArmed, "");
  parts_.jobs.attempts().arm({.job = row.id,
                              .sheet = row.sheet,
                              .blank = row.blank,
                              .device = *device,
                              .plan_sha256 = plan->sha256,
                              .operator_name = who.name,
                              .armed = parts_.store.now(),
                              .invocation = parts_.store.invocation()});
  const std::int64_t until = parts_.store.monotonic() + parts_.options.arm_s * 1000;
  parts_.store.after_commit([this, id = row.id, until, segment = row.segment,
                             first = row.first_stroke, folder = parts_.plans.folder_of(row.plan),
                             sheet = parts_.jobs.current_sheet(row)] {
    armed_here_[id] = {until, segment, first};
    if (sheet) parts_.programs.want(id, folder, sheet->number);
  });
  return {};
}

Answer<void> CutDispatcher::accept_warnings(JobRow& row, const ActionRequest& request) {
  std::string left = codes_without(row.unaccepted, request.accept_warnings);
  if (left.empty()) {
    row.unaccepted.clear();
    return {};
  }
  const std::vector<std::string> codes = codes_of(left);
  std::vector<std::string> messages;
  for (const Warning& one : warnings_from_json(row.warnings))
    if (one.spoils && std::find(codes.begin(), codes.end(), one.code) != codes.end())
      messages.push_back(one.message);
  Problem problem = JobRepository::conflict(
      row, fmt::format("this may spoil the sheet: {}; if it is what you want, accept it with "
                       "accept_warnings",
                       fmt::join(messages.empty() ? codes : messages, "; ")));
  problem.warnings = row.warnings;
  return tl::unexpected(std::move(problem));
}

bool CutDispatcher::knows_place(const JobRow& row, const std::string& device) const {
  if (row.segment == 1) return true;
  const auto placed = placed_.find(row.id);
  return placed != placed_.end() && placed->second == parts_.devices.session_of(device);
}

Answer<void> CutDispatcher::check_place(const JobRow& row, const std::string& device) const {
  if (knows_place(row, device)) return {};
  return tl::unexpected(JobRepository::conflict(
      row, fmt::format("{} or popcutd restarted, so the sheet's position is unknown; align the "
                       "sheet again and use resume-from with registration \"re-registered\" from "
                       "path {}, or use a new blank with retry-sheet",
                       device, row.first_stroke)));
}

Answer<void> CutDispatcher::pause(JobRow& row) {
  parts_.store.after_commit([this, device = row.device] { parts_.cutters.pause(device); });
  if (row.state == JobState::Paused || row.asked == "pause") return {};
  row.asked = "pause";
  row.reason = "pausing";
  parts_.jobs.save(row);
  return {};
}

Answer<void> CutDispatcher::resume(JobRow& row) {
  if (stopping_) return refuse(ProblemKind::Unavailable, "popcutd is stopping");
  if (const auto here = check_node(row.device); !here) return tl::unexpected(here.error());
  if (!cuts_.contains(row.id))
    return tl::unexpected(JobRepository::conflict(row, "its cut has already ended"));
  if (const auto device = parts_.devices.find(row.device); !device || !device->enabled)
    return tl::unexpected(JobRepository::conflict(
        row, row.device + " is disabled; an admin can enable it with the action enable"));
  if (row.state == JobState::Paused) {
    parts_.jobs.take(row, Step::ToCutting, "");
  } else {
    row.asked.clear();
    row.reason.clear();
    parts_.jobs.save(row);
  }
  parts_.store.after_commit([this, id = row.id, device = row.device] {
    if (const auto cut = cuts_.find(id); cut != cuts_.end()) cut->second->pause_asked = false;
    parts_.cutters.resume(device);
  });
  return {};
}

Answer<void> CutDispatcher::cancel(const Principal& who, JobRow& row,
                                   const ActionRequest& request) {
  const std::string reason = request.reason.empty() ? "cancelled by " + who.name : request.reason;
  if (row.state == JobState::Cutting || row.state == JobState::Paused) {
    parts_.store.after_commit([this, id = row.id, device = row.device] {
      if (const auto cut = cuts_.find(id); cut != cuts_.end()) cut->second->cancel_asked = true;
      parts_.cutters.cancel(device);
    });
    if (row.asked == "cancel") return {};
    row.asked = "cancel";
    row.reason = reason;
    parts_.jobs.save(row);
    return {};
  }
  if (row.state == JobState::Armed) parts_.jobs.attempts().disarm(row.id);
  parts_.programs.forget(row.id);
  parts_.jobs.take(row, Step::ToCancelled, reason);
  parts_.store.after_commit([this, plan = row.plan] { parts_.plans.abandon(plan); });
  return {};
}

Answer<void> CutDispatcher::confirm(JobRow& row, const ActionRequest& request) {
  if (!*request.good) {
    row.reason = "result_bad";
    parts_.jobs.set_attention(
        row, "in_doubt", "the result is not good; cut the sheet again on a new blank, or skip it");
    parts_.jobs.save(row);
    return {};
  }
  const Answer<Ledger> ledger = parts_.jobs.ledger(row.id, row.sheet);
  if (!ledger) return tl::unexpected(ledger.error());
  if (!ledger->not_sent.empty())
    return tl::unexpected(JobRepository::conflict(
        row, fmt::format("paths {}..{} were not cut, so the sheet is not finished; resume from "
                         "there, retry the sheet or skip it",
                         ledger->not_sent.front().first, ledger->not_sent.front().last)));
  record_usage(
      parts_.store, row,
      {.operator_name = row.operator_name, .device = row.device, .sheet = row.sheet, .sheets = 1});
  parts_.devices.count_sheet(row.device, 0, true);
  parts_.jobs.finish_sheet(row, "done", "confirmed");
  return {};
}

Answer<void> CutDispatcher::retry(JobRow& row) {
  const auto begun = parts_.jobs.attempts().last_begun(row.id, row.sheet);
  row.blank = std::max(row.blank, begun ? begun->blank : 0) + 1;
  row.segment = 1;
  row.first_stroke = 0;
  row.paths_certain = row.paths_sent = 0;
  parts_.jobs.take(row, Step::ToReady, "retry");
  placed_.erase(row.id);
  return {};
}

Answer<void> CutDispatcher::resume_from(JobRow& row, const ActionRequest& request) {
  const std::optional<ResumeState> state = resume_state(row);
  if (!state)
    return tl::unexpected(
        JobRepository::conflict(row, "this blank was never started; arm and start it"));
  const AttemptRow* const last = &state->last;
  if (const auto here = check_node(last->device); !here) return tl::unexpected(here.error());
  const auto plan = parts_.plans.table().find(row.plan);
  if (!plan || plan->sha256 != last->plan_sha256)
    return tl::unexpected(JobRepository::conflict(row, "the plan is not the one that was cut"));
  const auto may = may_resume(state->runs,
                              {.from_path = *request.from_path,
                               .re_registered = request.registration == "re-registered",
                               .accept_double_cut = request.accept_double_cut,
                               .skip_in_doubt = request.skip_in_doubt},
                              state->facts);
  if (!may) return tl::unexpected(JobRepository::conflict(row, may.error()));
  row.segment = last->segment + 1;
  row.first_stroke = *request.from_path;
  row.requested_device = last->device;
  placed_[row.id] = parts_.devices.session_of(last->device);
  parts_.store.after_commit([this, id = row.id, from = AskedFrom{row.segment, row.first_stroke}] {
    asked_from_[id] = from;
  });
  parts_.jobs.take(row, Step::ToReady, "resume");
  return {};
}

void CutDispatcher::lapse(const std::string& job, const std::string& reason) {
  const Answer<void> done = parts_.store.change([&]() -> Answer<void> {
    Answer<JobRow> row = parts_.jobs.row(job);
    if (!row || row->state != JobState::Armed) return {};
    // In a fleet it may be armed elsewhere by now.
    const auto arm = parts_.jobs.attempts().armed(job);
    if (arm && arm->node != parts_.store.node().name) return {};
    parts_.jobs.attempts().disarm(job);
    parts_.jobs.take(*row, step_of(row->state, JobEvent::ArmLapses), reason);
    return {};
  });
  // What could not be written is tried again; until then `start` looks at the time itself.
  if (!done) return;
  armed_here_.erase(job);
  parts_.programs.forget(job);
}

void CutDispatcher::tick() {
  const std::int64_t now = parts_.store.monotonic();
  std::vector<std::string> over;
  for (const auto& [job, arm] : armed_here_)
    if (arm.until_ms <= now) over.push_back(job);
  for (const std::string& job : over) lapse(job, "arm_expired");
  tell_again();
  if (parts_.store.degraded()) return;
  record_pauses();
  std::vector<std::shared_ptr<Cut>> refused;
  for (const auto& [job, cut] : cuts_)
    if (cut->refusal) refused.push_back(cut);
  for (const auto& cut : refused) record_refusal(cut);
  // A cut that is held, or that the database missed, has no progress that would tell it.
  for (const auto& [job, cut] : cuts_)
    if (cut->unmarked) (void)intended(*cut, cut->marks.intended);
  if (late_.empty()) return;
  const std::vector<LateEnd> late = std::exchange(late_, {});
  for (const LateEnd& one : late) ended(one.cut, one.end);
}

void CutDispatcher::devices_gone(const std::vector<std::string>& devices) {
  for (const std::string& device : devices) {
    try {
      const auto row = parts_.jobs.table().on_device(device);
      if (row && row->state == JobState::Armed) lapse(row->id, "device_gone");
    } catch (const StoreFault& fault) {
      parts_.store.note(fault);
    }
  }
}

Answer<void> CutDispatcher::check_node(const std::string& device) const {
  if (parts_.devices.is_elsewhere(device)) return tl::unexpected(parts_.devices.elsewhere(device));
  return {};
}

bool CutDispatcher::cuts(const std::string& attempt) const {
  return std::any_of(cuts_.begin(), cuts_.end(),
                     [&](const auto& one) { return one.second->attempt == attempt; });
}

std::string CutDispatcher::job_on(const std::string& device) const {
  for (const auto& [job, cut] : cuts_)
    if (cut->device == device) return job;
  return {};
}

void CutDispatcher::forget_arms() {
  for (const auto& [job, arm] : armed_here_) parts_.programs.forget(job);
  armed_here_.clear();
}

// True: it goes on.
bool CutDispatcher::take_up_one(Cut& cut) {
  switch (take_up(parts_.jobs, cut.attempt, cut.phase == SessionPhase::Held)) {
    case TakeUp::Goes:
      return true;
    case TakeUp::Superseded:
      cut.superseded = true;
      return false;
    case TakeUp::Ended:
      return false;
  }
  return false;
}

void CutDispatcher::take_up_cuts() {
  for (const auto& [job, cut] : cuts_) {
    if (cut->over) continue;  // its end takes it up
    const Answer<void> taken = parts_.store.change([&, one = cut.get()]() -> Answer<void> {
      (void)take_up_one(*one);
      return {};
    });
    if (!taken || !cut->superseded) continue;
    parts_.store.log(
        fmt::format("job {} sheet {}: while this node did not answer, somebody decided otherwise; "
                    "the cut stops",
                    cut->job, cut->sheet));
    parts_.cutters.cancel(cut->device);
  }
}

// What a person asked for while the database did not answer.
void CutDispatcher::record_pauses() {
  for (const auto& [job, cut] : cuts_)
    if (cut->pause_asked && cut->phase == SessionPhase::Held && !cut->over)
      progressed(*cut, SessionProgress(cut->told));
}

void CutDispatcher::doubt_start() {
  if (!starting_.empty() && !cuts(starting_)) doubtful_.insert(starting_);
}

bool CutDispatcher::take_back(const AttemptRow& attempt) {
  if (!doubtful_.contains(attempt.id) || parts_.intents.has(attempt.id)) return false;
  const Answer<void> noted = parts_.store.change([&]() -> Answer<void> {
    // Waits for the transaction of that START, if it is still under way.
    (void)parts_.store.db().number("SELECT rev FROM job WHERE id=? FOR UPDATE", attempt.job);
    const auto open = parts_.jobs.attempts().find(attempt.id);
    if (!open || open->ended) return {};
    Answer<JobRow> row = parts_.jobs.row(attempt.job);
    parts_.jobs.attempts().never_started(attempt.id, parts_.store.now());
    if (row && !is_terminal(row->state))
      parts_.jobs.take_left(*row, step_of(row->state, JobEvent::CutRefused),
                            "the database went away during the start; nothing was sent");
    return {};
  });
  if (noted) doubtful_.erase(attempt.id);
  return true;
}

void CutDispatcher::heed(const std::string& job) {
  const auto found = cuts_.find(job);
  if (found == cuts_.end() || found->second->over) return;
  Cut& cut = *found->second;
  (void)parts_.store.look([&]() -> Answer<void> {
    const Answer<JobRow> row = parts_.jobs.row(job);
    if (!row) return {};
    if (row->asked == "cancel" && !cut.cancel_asked) {
      cut.cancel_asked = true;
      parts_.cutters.cancel(cut.device);
    } else if (row->asked == "pause") {
      parts_.cutters.pause(cut.device);
    }
    return {};
  });
}

void CutDispatcher::stop_cuts() {
  for (const auto& [job, cut] : cuts_) parts_.cutters.cancel(cut->device);
}

}  // namespace popcut::daemon
