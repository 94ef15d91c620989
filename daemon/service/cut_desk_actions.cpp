// SPDX-License-Identifier: MIT
#include <algorithm>

#include <fmt/format.h>

#include "daemon/service/cut_desk_parts.hpp"

namespace popcut::daemon {
namespace {

Problem wrong_value(const std::string& pointer, const char* code, std::string advice) {
  return {ProblemKind::Validation, pointer + " is not valid", {{pointer, code, std::move(advice)}}};
}

bool needs_sheet(JobAction action) {
  return action == JobAction::Arm || action == JobAction::ConfirmResult ||
         action == JobAction::RetrySheet || action == JobAction::SkipSheet;
}

std::string audit_detail(const ActionWish& wish, const JobRow& row) {
  std::string detail =
      fmt::format("sheet {} blank {} segment {}", row.sheet, row.blank, row.segment);
  if (!row.device.empty()) detail += " on " + row.device;
  if (wish.good) detail += *wish.good ? " good" : " not good";
  if (wish.from_path)
    detail += fmt::format(" from path {}, registration {}{}{}", *wish.from_path, wish.registration,
                          wish.accept_double_cut ? ", double cut accepted" : "",
                          wish.skip_in_doubt ? ", doubt skipped" : "");
  if (!wish.reason.empty()) detail += ": " + wish.reason;
  return detail;
}

// Why those that are there cannot cut a plan: " (sim:a: it is set up for ...)"; empty: none is.
std::string why_none(const DeviceBook& devices, const PlanRow& plan) {
  constexpr std::size_t kMost = 3;
  std::vector<std::string> reasons;
  for (const DeviceRecord& device : devices.list())
    if (reasons.size() < kMost && devices.usable(device.id))
      reasons.push_back(fmt::format("{}: {}", device.id, devices.misfit(device.id, plan)));
  return reasons.empty() ? std::string() : fmt::format(" ({})", fmt::join(reasons, "; "));
}

}  // namespace

Answer<void> CutDesk::check_words(const JobRow& row, const ActionWish& wish) const {
  if (needs_sheet(wish.action) && !wish.sheet)
    return tl::unexpected(wrong_value("/sheet", "missing", fmt::format("must be {}", row.sheet)));
  if (const auto fine = check_text(wish.reason, 2000, "/reason"); !fine)
    return tl::unexpected(fine.error());
  if (wish.action == JobAction::ConfirmResult && !wish.good)
    return tl::unexpected(wrong_value("/good", "missing", "must be true or false"));
  if (wish.action != JobAction::ResumeFrom) return {};
  if (!wish.from_path) return tl::unexpected(wrong_value("/from_path", "missing", "must be a path"));
  if (wish.registration != "kept" && wish.registration != "re-registered")
    return tl::unexpected(wrong_value("/registration", wish.registration.empty() ? "missing" : "value",
                                "must be \"kept\" or \"re-registered\""));
  return {};
}

Answer<Job> CutDesk::act(const Principal& who, const std::string& id, std::int64_t if_match,
                         const ActionWish& wish) {
  JobBook& jobs = parts_.jobs;
  const bool to_the_knife = wish.action == JobAction::Pause || wish.action == JobAction::Cancel;
  try {
    // Not const: it is moved out, since a copy of an Answer ends the program without memory.
    Answer<Job> done = parts_.memory.change([&]() -> Answer<Job> {
      Answer<JobRow> found = jobs.row(id);
      if (!found) return tl::unexpected(found.error());
      JobRow& row = *found;
      const Role needed = role_for(wish.action, row.owner == who.name);
      if (who.role < needed)
        return refuse(ProblemKind::Forbidden,
                      fmt::format("{} needs the role {}", name_of(wish.action), name_of(needed)));
      if (const auto fresh = JobBook::check_rev(row, if_match); !fresh)
        return tl::unexpected(fresh.error());
      if (step_of(JobBook::facts_of(row), wish.action) == Step::Refused)
        return tl::unexpected(JobBook::conflict(
            row, fmt::format("{} is not possible while the job is {}{}", name_of(wish.action),
                             row.held ? "held and " : "", name_of(row.state))));
      if (const auto fine = check_words(row, wish); !fine) return tl::unexpected(fine.error());
      if (wish.sheet && *wish.sheet != row.sheet)
        return tl::unexpected(JobBook::conflict(
            row, fmt::format("sheet {} is the current one, not {}", row.sheet, *wish.sheet)));
      if (wish.blank && *wish.blank != row.blank)
        return tl::unexpected(JobBook::conflict(
            row, fmt::format("blank {} is the current one, not {}", row.blank, *wish.blank)));
      const std::string detail = audit_detail(wish, row);
      const Answer<void> taken = [&]() -> Answer<void> {
        switch (wish.action) {
          case JobAction::Arm:
            return arm(who, row, wish);
          case JobAction::Disarm:
            jobs.attempts().disarm(id);
            jobs.take(row, Step::ToReady, "disarmed");
            return {};
          case JobAction::Start:
            return start(who, row, wish);
          case JobAction::Pause:
            return pause(row);
          case JobAction::Resume:
            return resume(row);
          case JobAction::Cancel:
            return cancel(who, row, wish);
          case JobAction::ConfirmResult:
            return confirm(row, wish);
          case JobAction::RetrySheet:
            return retry(row);
          case JobAction::SkipSheet:
            jobs.finish_sheet(row, "skipped", "skipped");
            return {};
          case JobAction::ResumeFrom:
            return resume_from(row, wish);
        }
        return {};
      }();
      if (!taken) return tl::unexpected(taken.error());
      parts_.memory.audit(who.name, name_of(wish.action), id, detail);
      return jobs.shown(row);
    });
    const bool unwritten = !done && (done.error().kind == ProblemKind::DiskFull ||
                                     done.error().kind == ProblemKind::Unavailable);
    if (unwritten && to_the_knife) act_unrecorded(who, id, wish.action);
    return done;
  } catch (const StoreFault&) {
    if (to_the_knife) act_unrecorded(who, id, wish.action);
    throw;
  }
}

// Pausing and stopping are safe at any time, so they do not wait for the disk.
void CutDesk::act_unrecorded(const Principal& who, const std::string& id, JobAction action) {
  const auto found = cuts_.find(id);
  if (found == cuts_.end() || who.role < role_for(action, found->second->owner == who.name)) return;
  if (action == JobAction::Pause) {
    parts_.cutters.pause(found->second->device);
  } else {
    found->second->cancel_asked = true;
    parts_.cutters.cancel(found->second->device);
  }
}

Answer<std::string> CutDesk::choose_device(const JobRow& row, const ActionWish& wish,
                                           const PlanRow& plan) const {
  const DeviceBook& devices = parts_.devices;
  if (!wish.device.empty() && !row.wish.empty() && wish.device != row.wish)
    return tl::unexpected(JobBook::conflict(
        row,
        fmt::format("the job is for {}, not for {}{}", row.wish, wish.device,
                    row.segment > 1 ? ", where its sheet lies" : "; change its device first")));
  std::string device = wish.device.empty() ? row.wish : wish.device;
  if (!device.empty()) {
    if (!devices.find(device)) return tl::unexpected(devices.unknown(device, "/device"));
    if (const auto fine = devices.usable(device); !fine) return tl::unexpected(fine.error());
    if (const std::string why = devices.misfit(device, plan); !why.empty())
      return tl::unexpected(
          JobBook::conflict(row, fmt::format("{} cannot cut this: {}", device, why)));
    return device;
  }
  std::vector<std::string> fitting = devices.fitting(plan);
  if (fitting.empty())
    return refuse(ProblemKind::DeviceAbsent,
                  fmt::format("no {} is there that can cut this; plug one in and switch it on{}",
                              plan.machine, why_none(devices, plan)));
  if (fitting.size() > 1)
    std::erase_if(fitting, [&](const std::string& id) {
      return parts_.jobs.table().on_device(id).has_value();
    });
  if (fitting.size() != 1)
    return tl::unexpected(
        wrong_value("/device", "missing",
              fitting.empty()
                  ? std::string("all that fit are busy; say which one")
                  : fmt::format("say in which the sheet lies: {}", fmt::join(fitting, ", "))));
  return fitting.front();
}

Answer<void> CutDesk::arm(const Principal& who, JobRow& row, const ActionWish& wish) {
  const auto plan = parts_.plans.table().find(row.plan);
  if (!plan || plan->state != PlanState::Planned)
    return tl::unexpected(JobBook::conflict(row, "the job's plan is gone; make the job anew"));
  if (!wish.plan_sha256.empty() && wish.plan_sha256 != plan->sha256)
    return tl::unexpected(
        JobBook::conflict(row, "the plan is " + plan->sha256 + ", not the one that was named"));
  const Answer<std::string> device = choose_device(row, wish, *plan);
  if (!device) return tl::unexpected(device.error());
  if (const auto known = check_place(row, *device); !known) return tl::unexpected(known.error());
  if (const auto other = parts_.jobs.table().on_device(*device))
    return tl::unexpected(
        JobBook::conflict(row, fmt::format("{} has a sheet of job {} in it ({})", *device,
                                           other->id, name_of(other->state))));
  row.device = *device;
  row.operator_name = who.name;
  parts_.jobs.take(row, Step::ToArmed, "");
  parts_.jobs.attempts().arm({.job = row.id,
                              .sheet = row.sheet,
                              .blank = row.blank,
                              .device = *device,
                              .plan_sha256 = plan->sha256,
                              .operator_name = who.name,
                              .armed = parts_.memory.now(),
                              .invocation = parts_.memory.invocation()});
  const std::int64_t until = parts_.memory.monotonic() + parts_.options.arm_s * 1000;
  parts_.memory.after_commit([this, id = row.id, until] { armed_until_[id] = until; });
  return {};
}

bool CutDesk::knows_place(const JobRow& row, const std::string& device) const {
  if (row.segment == 1) return true;
  const auto placed = placed_.find(row.id);
  return placed != placed_.end() && placed->second == parts_.devices.session_of(device);
}

Answer<void> CutDesk::check_place(const JobRow& row, const std::string& device) const {
  if (knows_place(row, device)) return {};
  return tl::unexpected(JobBook::conflict(
      row, fmt::format("{} or popcutd was started anew since, so the sheet's place is no longer "
                       "known; register it again and say registration \"re-registered\" with "
                       "resume-from, from path {}, or take a new blank with retry-sheet",
                       device, row.first_stroke)));
}

Answer<void> CutDesk::pause(JobRow& row) {
  parts_.memory.after_commit([this, device = row.device] { parts_.cutters.pause(device); });
  if (row.state == JobState::Paused || row.asked == "pause") return {};
  row.asked = "pause";
  row.reason = "pausing";
  parts_.jobs.save(row);
  return {};
}

Answer<void> CutDesk::resume(JobRow& row) {
  if (stopping_) return refuse(ProblemKind::Unavailable, "popcutd is being stopped");
  if (!cuts_.contains(row.id))
    return tl::unexpected(JobBook::conflict(row, "its cut has ended already"));
  if (const auto device = parts_.devices.find(row.device); !device || !device->enabled)
    return tl::unexpected(JobBook::conflict(
        row, row.device + " is disabled; an admin enables it with the action enable"));
  if (row.state == JobState::Paused) {
    parts_.jobs.take(row, Step::ToCutting, "");
  } else {
    row.asked.clear();
    row.reason.clear();
    parts_.jobs.save(row);
  }
  parts_.memory.after_commit([this, device = row.device] { parts_.cutters.resume(device); });
  return {};
}

Answer<void> CutDesk::cancel(const Principal& who, JobRow& row, const ActionWish& wish) {
  const std::string reason = wish.reason.empty() ? "cancelled by " + who.name : wish.reason;
  if (row.state == JobState::Cutting || row.state == JobState::Paused) {
    parts_.memory.after_commit([this, id = row.id, device = row.device] {
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
  parts_.jobs.take(row, Step::ToCancelled, reason);
  parts_.memory.after_commit([this, plan = row.plan] { parts_.plans.abandon(plan); });
  return {};
}

Answer<void> CutDesk::confirm(JobRow& row, const ActionWish& wish) {
  if (!*wish.good) {
    row.reason = "result_bad";
    parts_.jobs.set_attention(row, "in_doubt",
                              "the result is not good: cut it again on a new blank, "
                              "or skip the sheet");
    parts_.jobs.save(row);
    return {};
  }
  const Answer<Ledger> ledger = parts_.jobs.ledger(row.id, row.sheet);
  if (!ledger) return tl::unexpected(ledger.error());
  if (!ledger->not_sent.empty())
    return tl::unexpected(JobBook::conflict(
        row, fmt::format("paths {}..{} were not cut, so the sheet is not finished; resume from "
                         "there, retry or skip it",
                         ledger->not_sent.front().first, ledger->not_sent.front().last)));
  parts_.memory.db().run(
      "INSERT INTO usage(time, owner, operator, device, material, job, k, seconds, cut_mm, sheets) "
      "VALUES(?, ?, ?, ?, ?, ?, ?, 0, 0, 1)",
      parts_.memory.now(), row.owner, row.operator_name, row.device, row.material, row.id,
      row.sheet);
  parts_.devices.count_sheet(row.device, 0, true);
  parts_.jobs.finish_sheet(row, "done", "confirmed");
  return {};
}

Answer<void> CutDesk::retry(JobRow& row) {
  ++row.blank;
  row.segment = 1;
  row.first_stroke = 0;
  row.paths_certain = row.paths_sent = 0;
  parts_.jobs.take(row, Step::ToReady, "retry");
  placed_.erase(row.id);
  return {};
}

Answer<void> CutDesk::resume_from(JobRow& row, const ActionWish& wish) {
  AttemptTable& attempts = parts_.jobs.attempts();
  std::vector<std::vector<FateRun>> fates;
  const std::vector<AttemptRow> all = attempts.of_sheet(row.id, row.sheet);
  const AttemptRow* last = nullptr;
  for (const AttemptRow& attempt : all) {
    if (attempt.blank != row.blank) continue;
    fates.push_back(attempts.fates(attempt.id));
    last = &attempt;
  }
  if (last == nullptr)
    return tl::unexpected(JobBook::conflict(row, "this blank was never started; arm and start it"));
  const auto plan = parts_.plans.table().find(row.plan);
  if (!plan || plan->sha256 != last->plan_sha256)
    return tl::unexpected(JobBook::conflict(row, "the plan is not the one that was cut"));
  const auto may = may_resume(
      merged_fates(last->strokes, fates),
      {.from_path = *wish.from_path,
       .re_registered = wish.registration == "re-registered",
       .accept_double_cut = wish.accept_double_cut,
       .skip_in_doubt = wish.skip_in_doubt},
      {.strokes = last->strokes,
       .same_device_session = last->end_kind != "media_out" &&
                              last->device_session == parts_.devices.session_of(last->device)});
  if (!may) return tl::unexpected(JobBook::conflict(row, may.error()));
  row.segment = last->segment + 1;
  row.first_stroke = *wish.from_path;
  row.wish = last->device;
  placed_[row.id] = parts_.devices.session_of(last->device);
  parts_.jobs.take(row, Step::ToReady, "resume");
  return {};
}

void CutDesk::lapse(const std::string& job, const std::string& reason) {
  const Answer<void> done = parts_.memory.change([&]() -> Answer<void> {
    Answer<JobRow> row = parts_.jobs.row(job);
    if (!row || row->state != JobState::Armed) return {};
    parts_.jobs.attempts().disarm(job);
    parts_.jobs.take(*row, step_of(row->state, JobEvent::ArmLapses), reason);
    return {};
  });
  // What could not be written is tried again; until then `start` looks at the time itself.
  if (done) armed_until_.erase(job);
}

void CutDesk::tick() {
  const std::int64_t now = parts_.memory.monotonic();
  std::vector<std::string> over;
  for (const auto& [job, until] : armed_until_)
    if (until <= now) over.push_back(job);
  for (const std::string& job : over) lapse(job, "arm_expired");
  if (parts_.memory.degraded()) return;
  std::vector<std::shared_ptr<Cut>> refused;
  for (const auto& [job, cut] : cuts_)
    if (cut->refusal) refused.push_back(cut);
  for (const auto& cut : refused) record_refusal(cut);
  if (late_.empty()) return;
  const std::vector<LateEnd> late = std::exchange(late_, {});
  for (const LateEnd& one : late) ended(one.cut, one.end);
}

void CutDesk::devices_gone(const std::vector<std::string>& devices) {
  for (const std::string& device : devices) {
    try {
      const auto row = parts_.jobs.table().on_device(device);
      if (row && row->state == JobState::Armed) lapse(row->id, "device_gone");
    } catch (const StoreFault& fault) {
      parts_.memory.note(fault);
    }
  }
}

void CutDesk::stop_cuts() {
  for (const auto& [job, cut] : cuts_) parts_.cutters.cancel(cut->device);
}

}  // namespace popcut::daemon
