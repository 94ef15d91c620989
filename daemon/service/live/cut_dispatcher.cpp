// SPDX-License-Identifier: MIT
#include "daemon/service/live/cut_dispatcher.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "daemon/model/input_limits.hpp"
#include "daemon/model/warnings.hpp"
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

// Why usable devices cannot cut a plan: " (sim:a: it is set up for ...)"; empty if no device is
// usable.
std::string why_none(const DeviceRegistry& devices, const PlanRow& plan, const std::string& site) {
  constexpr std::size_t kMost = 3;
  std::vector<std::string> reasons;
  for (const DeviceRecord& device : devices.list())
    if (reasons.size() < kMost && devices.usable(device.id))
      reasons.push_back(fmt::format("{}: {}", device.id, devices.misfit(device.id, plan, site)));
  return reasons.empty() ? std::string() : fmt::format(" ({})", fmt::join(reasons, "; "));
}

}  // namespace

Answer<void> CutDispatcher::check_members(const JobRow& row, const ActionRequest& request) const {
  if (needs_sheet(request.action) && !request.sheet)
    return refuse_value("/sheet", "missing", fmt::format("must be {}", row.sheet));
  if (auto fine = check_text(request.reason, kReasonLimit, "/reason"); !fine) return fine;
  if (request.action == JobAction::ConfirmResult && !request.good)
    return refuse_value("/good", "missing", "must be true or false");
  if (request.action == JobAction::ResumeFrom) {
    if (!request.from_path) return refuse_value("/from_path", "missing", "must be a path");
    if (request.registration != "kept" && request.registration != "re-registered")
      return refuse_value("/registration", request.registration.empty() ? "missing" : "value",
                          "must be \"kept\" or \"re-registered\"");
  }
  if (request.sheet && *request.sheet != row.sheet)
    return JobRepository::refuse_state(
        row, fmt::format("the current sheet is {}, not {}", row.sheet, *request.sheet));
  if (request.blank && *request.blank != row.blank)
    return JobRepository::refuse_state(
        row, fmt::format("the current blank is {}, not {}", row.blank, *request.blank));
  return {};
}

Answer<Job> CutDispatcher::act(const Principal& who, const std::string& id, std::int64_t if_match,
                               const ActionRequest& request) {
  const bool stops_knife =
      request.action == JobAction::Pause || request.action == JobAction::Cancel;
  const struct Placed {
    std::optional<Placing>& placing;
    ~Placed() { placing.reset(); }
  } placed{placing_};
  try {
    // Not const, so that it is moved when it is returned. A copy needs memory; without any it would
    // end the program.
    Answer<Job> done = parts_.store.change([&]() -> Answer<Job> {
      Answer<JobRow> row = parts_.jobs.row(id);
      if (!row) return tl::unexpected(row.error());
      const Role needed = role_for(request.action, row->owner == who.name);
      if (who.role < needed)
        return refuse(
            ProblemKind::Forbidden,
            fmt::format("{} requires the role {}", name_of(request.action), name_of(needed)));
      if (const auto fresh = JobRepository::check_rev(*row, if_match); !fresh)
        return tl::unexpected(fresh.error());
      const JobRow before = *row;
      Answer<Job> acted = act_on(who, *row, request);
      // A refusal lists complete requests that are possible.
      const bool may_write = !parts_.store.degraded() && !parts_.cuts.is_stopping();
      if (!acted && acted.error().next_actions.empty() && may_write)
        acted.error().next_actions = next_actions(before, &request);
      return acted;
    });
    const bool is_unrecorded = !done && (done.error().kind == ProblemKind::DiskFull ||
                                         done.error().kind == ProblemKind::Unavailable);
    if (is_unrecorded && stops_knife) stop_unrecorded(who, id, request.action);
    return done;
  } catch (const StoreFault&) {
    if (stops_knife) stop_unrecorded(who, id, request.action);
    throw;
  }
}

Answer<Job> CutDispatcher::act_on(const Principal& who, JobRow& row, const ActionRequest& request) {
  if (step_of(JobRepository::facts_of(row), request.action) == Step::Refused)
    return JobRepository::refuse_state(
        row, fmt::format("{} is not possible while the job is {}{}", name_of(request.action),
                         row.held ? "held and " : "", name_of(row.state)));
  if (const auto fine = check_members(row, request); !fine) return tl::unexpected(fine.error());
  const std::string detail = audit_detail(request, row);
  if (const auto changed = change(who, row, request); !changed)
    return tl::unexpected(changed.error());
  parts_.store.audit(who.name, name_of(request.action), row.id, detail);
  return parts_.jobs.shown(row);
}

Answer<void> CutDispatcher::change(const Principal& who, JobRow& row,
                                   const ActionRequest& request) {
  switch (request.action) {
    case JobAction::Arm:
      return arm(who, row, request);
    case JobAction::Disarm:
      return disarm(row);
    case JobAction::Start:
      return start(who, row);
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
      parts_.jobs.finish_sheet(row, "skipped", "skipped");
      return {};
    case JobAction::ResumeFrom:
      return resume_from(row, request);
  }
  return {};
}

// Pausing and stopping are safe at any time, so they do not wait for the disk.
void CutDispatcher::stop_unrecorded(const Principal& who, const std::string& id, JobAction action) {
  const Cut* const cut = parts_.cuts.of_job(id);
  if (cut == nullptr || who.role < role_for(action, cut->owner == who.name)) return;
  if (action == JobAction::Pause)
    parts_.cuts.pause_unrecorded(id);
  else
    parts_.cuts.cancel(id, cut->attempt.device);
}

Answer<std::string> CutDispatcher::choose_device(const JobRow& row, const ActionRequest& request,
                                                 const PlanRow& plan) const {
  const DeviceRegistry& devices = parts_.devices;
  if (!request.device.empty() && !row.requested_device.empty() &&
      request.device != row.requested_device)
    return JobRepository::refuse_state(
        row,
        fmt::format("the job is for {}, not for {}{}", row.requested_device, request.device,
                    row.segment > 1 ? ", which holds its sheet" : "; change its device first"));
  std::string device = request.device.empty() ? row.requested_device : request.device;
  if (!device.empty()) {
    if (!devices.find(device)) return tl::unexpected(devices.unknown(device, "/device"));
    if (const auto fine = devices.usable(device); !fine) return tl::unexpected(fine.error());
    if (const std::string why = devices.wrong_site(device, row.site); !why.empty())
      return JobRepository::refuse_state(row,
                                         fmt::format("{} {}; change its site first", device, why));
    if (const std::string why = devices.misfit(device, plan, row.site); !why.empty())
      return JobRepository::refuse_state(row, fmt::format("{} cannot cut this: {}", device, why));
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
  for (const std::string& one : fitting) unnamed.next_actions.push_back(arm_action(row, one));
  return tl::unexpected(std::move(unnamed));
}

Answer<void> CutDispatcher::arm(const Principal& who, JobRow& row, const ActionRequest& request) {
  if (auto sound = parts_.store.accepts_arming(); !sound) return sound;
  if (auto may = parts_.cuts.may_cut(); !may) return may;
  const auto plan = parts_.plans.table().find(row.plan);
  const auto sheet = parts_.jobs.current_sheet(row);
  if (!plan || plan->state != PlanState::Planned || !sheet)
    return JobRepository::refuse_state(row, "the job's plan is gone; create the job again");
  if (!request.plan_sha256.empty() && request.plan_sha256 != plan->sha256)
    return JobRepository::refuse_state(
        row, "the plan is " + plan->sha256 + ", not the one in the request");
  if (const std::string why = parts_.intents.why_blocked(row.id); !why.empty())
    return JobRepository::refuse_state(row, why);
  const std::vector<Warning> changed = parts_.jobs.changed_since_planned(row);
  for (const Warning& one : changed) {
    row.unaccepted.push_back(one.code);
    row.warnings.insert(row.warnings.begin(), one);
  }
  const Answer<std::string> device = choose_device(row, request, *plan);
  if (!device) return tl::unexpected(device.error());
  if (auto known = check_place(row, *device); !known) return known;
  if (const auto other = parts_.jobs.table().on_device(*device))
    return JobRepository::refuse_state(row, fmt::format("{} holds a sheet of job {} ({})", *device,
                                                        other->id, name_of(other->state)));
  if (auto accepted = accept_warnings(row, request); !accepted) {
    // The warnings about changed tables are in `row` now. `next_actions` adds them itself, so it
    // gets the row without them.
    if (!changed.empty()) {
      JobRow known = row;
      std::erase_if(known.warnings, [&](const Warning& one) {
        return std::any_of(changed.begin(), changed.end(),
                           [&](const Warning& fresh) { return fresh.code == one.code; });
      });
      accepted.error().next_actions = next_actions(known, &request);
    }
    return accepted;
  }
  if (auto here = parts_.plans.fetch_sheet(row.plan, sheet->number); !here) return here;
  const auto known = next_.find(row.id);
  const Waiting waiting = known == next_.end() ? Waiting{} : waiting_of(known->second);
  if (waiting.resume_at && waiting.resume_at->segment == row.segment &&
      waiting.resume_at->first_stroke != row.first_stroke)
    return JobRepository::refuse_state(
        row,
        fmt::format("this sheet would resume at path {}, but path {} was requested last; use a "
                    "new blank with retry-sheet",
                    row.first_stroke, waiting.resume_at->first_stroke));
  row.device = *device;
  row.operator_name = who.name;
  parts_.jobs.apply(row, Step::ToArmed, "");
  parts_.jobs.attempts().arm({.job = row.id,
                              .sheet = row.sheet,
                              .blank = row.blank,
                              .device = *device,
                              .plan_sha256 = plan->sha256,
                              .operator_name = who.name,
                              .armed = parts_.store.now(),
                              .invocation = parts_.store.invocation()});
  const Armed armed{.until_ms = parts_.store.monotonic() + parts_.options.arm_s * 1000,
                    .start = {row.segment, row.first_stroke},
                    .waiting = waiting};
  parts_.store.after_commit([this, id = row.id, armed, folder = parts_.plans.folder_of(row.plan),
                             number = sheet->number] {
    next_[id] = armed;
    parts_.programs.read_ahead(id, folder, number);
  });
  return {};
}

Answer<void> CutDispatcher::disarm(JobRow& row) {
  parts_.jobs.disarm(row.id);
  parts_.jobs.apply(row, Step::ToReady, "disarmed");
  return {};
}

Answer<void> CutDispatcher::accept_warnings(JobRow& row, const ActionRequest& request) {
  const std::vector<std::string> codes = codes_without(row.unaccepted, request.accept_warnings);
  if (codes.empty()) {
    row.unaccepted.clear();
    return {};
  }
  std::vector<std::string> messages;
  for (const Warning& one : row.warnings)
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
  const std::string session = parts_.devices.session_of(device);
  if (placing_ && placing_->job == row.id) return placing_->session == session;
  const auto known = next_.find(row.id);
  return known != next_.end() && waiting_of(known->second).placed_in == session;
}

std::optional<std::int64_t> CutDispatcher::arm_left_ms(const std::string& job) const {
  const auto next = next_.find(job);
  const auto* const armed = next == next_.end() ? nullptr : std::get_if<Armed>(&next->second);
  if (armed == nullptr) return std::nullopt;
  return armed->until_ms - parts_.store.monotonic();
}

Answer<void> CutDispatcher::check_place(const JobRow& row, const std::string& device) const {
  if (knows_place(row, device)) return {};
  return JobRepository::refuse_state(
      row, fmt::format("{} or popcutd restarted, so the sheet's position is unknown; align the "
                       "sheet again and use resume-from with registration \"re-registered\" from "
                       "path {}, or use a new blank with retry-sheet",
                       device, row.first_stroke));
}

Answer<void> CutDispatcher::check_armed(const JobRow& row, const std::optional<PlanRow>& plan) {
  const auto stored = parts_.jobs.attempts().armed(row.id);
  const Armed* const here = valid_arm(row.id);
  if (!stored || here == nullptr)
    return JobRepository::refuse_state(row, "arming has expired; disarm and arm again");
  const bool is_same = plan && stored->sheet == row.sheet && stored->blank == row.blank &&
                       here->start == CutStart{row.segment, row.first_stroke} &&
                       stored->device == row.device && stored->plan_sha256 == plan->sha256;
  if (is_same) return {};
  return JobRepository::refuse_state(
      row, "the armed sheet is not the one that would be cut; disarm and arm again");
}

Answer<void> CutDispatcher::check_device(const JobRow& row, const PlanRow& plan) const {
  if (auto fine = parts_.devices.usable(row.device); !fine) return fine;
  if (const std::string why = parts_.devices.misfit(row.device, plan, row.site); !why.empty())
    return JobRepository::refuse_state(
        row, fmt::format("{} can no longer cut this: {}", row.device, why));
  if (auto known = check_place(row, row.device); !known) return known;
  const auto device = parts_.devices.find(row.device);
  if (device->state == "idle" || device->state == "attention") return {};
  return JobRepository::refuse_state(
      row, fmt::format("{} is {}{}{}; start when it is idle", row.device, device->state,
                       device->reasons.empty() ? "" : ": ", fmt::join(device->reasons, ", ")));
}

Answer<CutDispatcher::ReadySheet> CutDispatcher::ready_sheet(const JobRow& row) {
  const auto sheet = parts_.jobs.current_sheet(row);
  if (!sheet) return JobRepository::refuse_state(row, "the job's plan has no such sheet");
  auto found = parts_.programs.find(row.id, parts_.plans.folder_of(row.plan), sheet->number);
  if (!found) {
    return refuse(ProblemKind::Unavailable,
                  "the program of this sheet is large and still being read; start again in a "
                  "moment",
                  /*retry_after_s=*/1);
  }
  Result<ProgramShelf::Program>& stored = *found;
  // Lists only cancel as a next action, because arming the job again would not help.
  const auto lost = [&](std::string detail) {
    Problem problem = JobRepository::conflict(row, std::move(detail));
    problem.next_actions = {next_action(JobAction::Cancel)};
    return tl::unexpected(std::move(problem));
  };
  if (!stored)
    return lost("the stored program cannot be read; create the job again: " +
                message(stored.error()));
  // Cut only what was armed, never a stored program that has changed.
  EncodedProgram& program = stored->stored.program;
  const bool is_same = stored->sha256 == sheet->program_sha256 &&
                       stored->stored.index_sha256 == sheet->index_sha256 &&
                       static_cast<int>(program.strokes.size()) == sheet->paths;
  if (!is_same)
    return lost("the stored program is not the one that was planned; create the job again");
  return ReadySheet{*sheet, std::move(program)};
}

Answer<void> CutDispatcher::start(const Principal& who, JobRow& row) {
  if (parts_.cuts.is_stopping()) return refuse(ProblemKind::Unavailable, "popcutd is stopping");
  if (auto here = check_node(row.device); !here) return here;
  if (auto may = parts_.cuts.may_cut(); !may) return may;
  const std::optional<PlanRow> plan = parts_.plans.table().find(row.plan);
  if (auto armed = check_armed(row, plan); !armed) return armed;
  if (auto fine = check_device(row, *plan); !fine) return fine;
  row.operator_name = who.name;
  Answer<ReadySheet> sheet = ready_sheet(row);
  if (!sheet) return tl::unexpected(sheet.error());
  const TimeMs now = parts_.store.now();
  auto cut = std::make_shared<Cut>();
  cut->attempt = {.id = parts_.store.new_id(),
                  .job = row.id,
                  .sheet = row.sheet,
                  .blank = row.blank,
                  .segment = row.segment,
                  .first_stroke = row.first_stroke,
                  .strokes = static_cast<std::int64_t>(sheet->program.strokes.size()),
                  .device = row.device,
                  .device_session = parts_.devices.session_of(row.device),
                  .operator_name = who.name,
                  .plan_sha256 = plan->sha256,
                  .invocation = parts_.store.invocation(),
                  .created = now,
                  .started = now};
  cut->owner = row.owner;
  cut->length_mm = sheet->plan.cut_mm + sheet->plan.fold_mm;
  cut->dots = sheet->program.dots;
  cut->marks = {.first = row.first_stroke,
                .certain = row.first_stroke - 1,
                .taken = row.first_stroke - 1,
                .intended = row.first_stroke - 1};
  CutOrder order{.attempt = cut->attempt.id,
                 .device = row.device,
                 .program = std::move(sheet->program),
                 .area_mm = sheet->plan.area_mm,
                 .first_stroke = row.first_stroke};
  parts_.store.after_commit([this, id = row.id] {
    next_.erase(id);
    parts_.programs.forget(id);
  });
  try {
    parts_.cuts.start(std::move(cut), std::move(order));
  } catch (const StoreFault& fault) {
    if (fault.kind() != FaultKind::Constraint) throw;
    Problem used = JobRepository::conflict(
        row, "this blank was started before; disarm it and use a new one with retry-sheet");
    used.next_actions = {next_action(JobAction::Disarm)};
    return tl::unexpected(std::move(used));
  }
  parts_.jobs.apply(row, Step::ToCutting, "");
  return {};
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
  if (parts_.cuts.is_stopping()) return refuse(ProblemKind::Unavailable, "popcutd is stopping");
  if (auto here = check_node(row.device); !here) return here;
  if (parts_.cuts.of_job(row.id) == nullptr)
    return JobRepository::refuse_state(row, "its cut has already ended");
  if (const auto device = parts_.devices.find(row.device); !device || !device->enabled)
    return JobRepository::refuse_state(
        row, row.device + " is disabled; an admin can enable it with the action enable");
  if (row.state == JobState::Paused) {
    parts_.jobs.apply(row, Step::ToCutting, "");
  } else {
    row.asked.clear();
    row.reason.clear();
    parts_.jobs.save(row);
  }
  parts_.store.after_commit([this, id = row.id, device = row.device] {
    parts_.cuts.forget_pause(id);
    parts_.cutters.resume(device);
  });
  return {};
}

Answer<void> CutDispatcher::cancel(const Principal& who, JobRow& row,
                                   const ActionRequest& request) {
  const std::string reason = request.reason.empty() ? "cancelled by " + who.name : request.reason;
  if (row.state == JobState::Cutting || row.state == JobState::Paused) {
    parts_.store.after_commit(
        [this, id = row.id, device = row.device] { parts_.cuts.cancel(id, device); });
    if (row.asked == "cancel") return {};
    row.asked = "cancel";
    row.reason = reason;
    parts_.jobs.save(row);
    return {};
  }
  if (row.state == JobState::Armed) parts_.jobs.disarm(row.id);
  parts_.jobs.apply(row, Step::ToCancelled, reason);
  parts_.store.after_commit([this, id = row.id, plan = row.plan] {
    next_.erase(id);
    parts_.plans.cancel_if_unwanted(plan);
  });
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
    return JobRepository::refuse_state(
        row, fmt::format("paths {}..{} were not cut, so the sheet is not finished; resume from "
                         "there, retry the sheet or skip it",
                         ledger->not_sent.front().first, ledger->not_sent.front().last));
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
  parts_.jobs.apply(row, Step::ToReady, "retry");
  parts_.store.after_commit([this, id = row.id] { next_.erase(id); });
  return {};
}

Answer<void> CutDispatcher::resume_from(JobRow& row, const ActionRequest& request) {
  const std::optional<ResumeState> state = resume_state(row);
  if (!state)
    return JobRepository::refuse_state(row, "this blank was never started; arm and start it");
  const AttemptRow* const last = &state->last;
  if (auto here = check_node(last->device); !here) return here;
  const auto plan = parts_.plans.table().find(row.plan);
  if (!plan || plan->sha256 != last->plan_sha256)
    return JobRepository::refuse_state(row, "the plan is not the one that was cut");
  const auto may = may_resume(state->runs,
                              {.from_path = *request.from_path,
                               .re_registered = request.registration == "re-registered",
                               .accept_double_cut = request.accept_double_cut,
                               .skip_in_doubt = request.skip_in_doubt},
                              state->facts);
  if (!may) return JobRepository::refuse_state(row, may.error());
  row.segment = last->segment + 1;
  row.first_stroke = *request.from_path;
  row.requested_device = last->device;
  const std::string session = parts_.devices.session_of(last->device);
  placing_ = Placing{row.id, session};
  parts_.store.after_commit(
      [this, id = row.id, session, at = CutStart{row.segment, row.first_stroke}] {
        next_[id] = Waiting{.placed_in = session, .resume_at = at};
      });
  parts_.jobs.apply(row, Step::ToReady, "resume");
  return {};
}

void CutDispatcher::disarm_because(const std::string& job, const std::string& reason) {
  const Answer<void> done = parts_.store.change([&]() -> Answer<void> {
    Answer<JobRow> row = parts_.jobs.row(job);
    if (!row || row->state != JobState::Armed) return {};
    // In a fleet it may be armed elsewhere by now.
    const auto arm = parts_.jobs.attempts().armed(job);
    if (arm && arm->node != parts_.store.node().name) return {};
    parts_.jobs.disarm(job);
    parts_.jobs.apply(*row, step_of(row->state, JobEvent::ArmLapses), reason);
    return {};
  });
  // If this could not be stored, `tick` tries again. Until then `valid_arm` refuses START, because
  // it compares the time itself.
  if (done) forget_arm(job);
}

void CutDispatcher::forget_arm(const std::string& job) {
  parts_.programs.forget(job);
  const auto found = next_.find(job);
  if (found == next_.end() || !std::holds_alternative<Armed>(found->second)) return;
  Waiting waiting = std::move(std::get<Armed>(found->second).waiting);
  found->second = std::move(waiting);
}

void CutDispatcher::tick() {
  const std::int64_t now = parts_.store.monotonic();
  std::vector<std::string> over;
  for (const auto& [job, next] : next_)
    if (const auto* const armed = std::get_if<Armed>(&next);
        armed != nullptr && armed->until_ms <= now)
      over.push_back(job);
  for (const std::string& job : over) disarm_because(job, "arm_expired");
}

void CutDispatcher::devices_gone(const std::vector<std::string>& devices) {
  for (const std::string& device : devices) {
    try {
      const auto row = parts_.jobs.table().on_device(device);
      if (row && row->state == JobState::Armed) disarm_because(row->id, "device_gone");
    } catch (const StoreFault& fault) {
      parts_.store.handle_fault(fault);
    }
  }
}

Answer<void> CutDispatcher::check_node(const std::string& device) const {
  if (parts_.devices.is_elsewhere(device)) return tl::unexpected(parts_.devices.elsewhere(device));
  return {};
}

void CutDispatcher::forget_arms() {
  for (auto& [job, next] : next_)
    if (std::holds_alternative<Armed>(next)) forget_arm(job);
}

}  // namespace popcut::daemon
