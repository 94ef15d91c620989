// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cstdlib>
#include <map>

#include <fmt/format.h>

#include "daemon/service/repositories/job_repository.hpp"

namespace popcut::daemon {
namespace {

constexpr std::int64_t kClocksDiffer_ms = 1000;

Problem bad_cursor() {
  return invalid_value("?cursor", "format", "must be the next_cursor of the previous page",
                       "the cursor is not valid");
}

}  // namespace

JobFacts JobRepository::facts_of(const JobRow& row) {
  return {.state = row.state,
          .held = row.held,
          .pausing = row.asked == "pause",
          .cancelling = row.asked == "cancel",
          .awaits_result = row.attention_kind == "confirm_result",
          .begun = row.segment > 1};
}

bool JobRepository::lost_its_place(const JobRow& row) const {
  return row.state == JobState::Ready && row.segment > 1 && knows_place && !knows_place(row);
}

std::vector<NextAction> JobRepository::next_actions_of(const JobRow& row) const {
  std::vector<NextAction> all = next_actions ? next_actions(row) : std::vector<NextAction>{};
  for (NextAction& one : all)
    if (one.device.empty() && one.job.empty()) one.job = row.id;
  return all;
}

tl::unexpected<Problem> JobRepository::refused(const JobRow& row, Problem problem) const {
  if (problem.next_actions.empty()) problem.next_actions = next_actions_of(row);
  return tl::unexpected(std::move(problem));
}

std::vector<NextAction> JobRepository::other_devices(const JobRow& row) const {
  constexpr std::size_t kMost = 3;
  std::vector<NextAction> all;
  const auto plan = const_cast<JobRepository*>(this)->parts_.plans.table().find(row.plan);
  if (!plan || row.segment > 1) return all;
  for (const std::string& id : parts_.devices.fitting(*plan, row.site))
    if (id != row.requested_device && all.size() < kMost)
      all.push_back({.action = "change", .body = JobPatch{.device = id}});
  return all;
}

std::vector<std::string> JobRepository::actions_of(const JobRow& row) const {
  std::vector<std::string> names;
  for (const JobAction action : allowed_actions(facts_of(row)))
    if (action != JobAction::Arm || !lost_its_place(row)) names.emplace_back(name_of(action));
  return names;
}

std::optional<Attention> JobRepository::attention_of(const JobRow& row) const {
  if (row.attention_kind.empty()) return std::nullopt;
  Attention attention{.kind = row.attention_kind,
                      .sheet = row.sheet,
                      .total = row.sheets_total,
                      .text = row.attention_text,
                      .since = row.attention_since};
  if (row.state == JobState::Ready && !row.requested_device.empty()) {
    const auto device = parts_.devices.find(row.requested_device);
    if (!device || device->state == "absent" || device->state == "offline") {
      attention.kind = "device_absent";
      attention.text = fmt::format("{} is not available; plug it in and switch it on, then {}",
                                   row.requested_device, row.attention_text);
    } else if (device->enabled && device->state == "fault") {
      attention.kind = "device_fault";
      attention.text = fmt::format("{} is in fault{}{}; fix the cause and reset it, then {}",
                                   row.requested_device, device->reasons.empty() ? "" : ": ",
                                   fmt::join(device->reasons, ", "), row.attention_text);
    }
  }
  if (lost_its_place(row))
    attention.text = fmt::format(
        "sheet {} of {} was to continue from path {}, but {} or popcutd restarted; align the sheet "
        "again and resume it as re-registered, or use a new blank",
        row.sheet, row.sheets_total, row.first_stroke, row.requested_device);
  attention.actions = actions_of(row);
  return attention;
}

std::optional<TimeMs> JobRepository::armed_until(const JobRow& row) const {
  if (row.state != JobState::Armed) return std::nullopt;
  const auto arm = const_cast<JobRepository*>(this)->attempts_.armed(row.id);
  if (!arm) return std::nullopt;
  const TimeMs until = arm->armed + parts_.options.arm_s * 1000;
  // The arm expires by the monotonic clock. `until` is by the wall clock, and is wrong if that was
  // set since.
  const bool is_here = arm_left_ms && arm->node == parts_.store.node().name;
  const auto left_ms = is_here ? arm_left_ms(row.id) : std::nullopt;
  const TimeMs here = parts_.store.now() + left_ms.value_or(0);
  return left_ms && std::abs(here - until) > kClocksDiffer_ms ? here : until;
}

// The stored warnings, and those about the devices that are there now.
std::vector<Warning> JobRepository::warnings_of(const JobRow& row) const {
  std::vector<Warning> all = row.warnings;
  if (!row.site.empty() && !is_terminal(row.state) && !parts_.devices.has_site(row.site))
    all.insert(all.begin(), {.code = "no_cutter_at_site",
                             .message = fmt::format("no cutter is at site {}; the job waits for "
                                                    "one, or until you change its site",
                                                    row.site)});
  return all;
}

std::vector<Warning> JobRepository::changed_since_planned(const JobRow& row) const {
  if (row.state != JobState::Ready) return {};
  PlanningQueue& plans = const_cast<JobRepository*>(this)->parts_.plans;
  const auto plan = plans.table().find(row.plan);
  if (!plan) return {};
  std::vector<Warning> all = plans.changed_since(*plan);
  // A warning that a person accepted is in the job's row.
  std::erase_if(all, [&](const Warning& one) {
    return std::any_of(row.warnings.begin(), row.warnings.end(), [&](const Warning& known) {
      return known.code == one.code && known.message == one.message;
    });
  });
  return all;
}

Job JobRepository::shown(const JobRow& row) const {
  Job job{row};
  if (row.design.empty()) job.kind = "test-cut";
  if (row.device.empty()) job.device = row.requested_device;
  job.owner_title = parts_.titles.of(row.owner);
  job.operator_title = parts_.titles.of(row.operator_name);
  job.progress = {.paths_certain = row.done_paths + row.paths_certain,
                  .paths_sent = row.done_paths + row.paths_sent,
                  .paths_total = row.paths_total,
                  .paths_done = row.done_paths + row.paths_certain,
                  .cut_mm = row.done_mm};
  std::array<double, 2>& left_s = job.est.remaining_s = {row.low_s, row.high_s};
  if (const LiveCut* now = live ? live(row.id) : nullptr) {
    job.progress.paths_certain = row.done_paths + now->certain;
    job.progress.paths_sent = row.done_paths + now->sent;
    job.progress.paths_done = row.done_paths + std::max(now->certain, now->done);
    if (const auto sheet = const_cast<JobRepository*>(this)->current_sheet(row)) {
      job.progress.cut_mm += (sheet->cut_mm + sheet->fold_mm) * now->cut_share;
      const double over = now->seconds_left < 0 || sheet->seconds <= 0
                              ? 0.0
                              : std::clamp(1 - now->seconds_left / sheet->seconds, 0.0, 1.0);
      left_s[0] = std::max(0.0, row.low_s - over * sheet->seconds_range[0]);
      left_s[1] = std::max(0.0, row.high_s - over * sheet->seconds_range[1]);
    }
  }
  job.warnings = warnings_of(row);
  job.attention = attention_of(row);
  job.armed_until = armed_until(row);
  job.actions = actions_of(row);
  return job;
}

Problem JobRepository::conflict(const JobRow& row, std::string detail) {
  Problem problem{ProblemKind::StateConflict, std::move(detail)};
  problem.rev = row.rev;
  problem.state = name_of(row.state);
  for (const JobAction action : allowed_actions(facts_of(row)))
    problem.allowed_actions.emplace_back(name_of(action));
  return problem;
}

Answer<void> JobRepository::check_rev(const JobRow& row, std::int64_t if_match) {
  if (row.rev == if_match) return {};
  Problem problem = conflict(
      row, fmt::format(
               "the job has changed (it is at revision {}, the request was for {}); read it again",
               row.rev, if_match));
  problem.kind = ProblemKind::Stale;
  return tl::unexpected(std::move(problem));
}

Answer<Page<Job>> JobRepository::list(const JobFilter& filter, const PageRequest& request) {
  if (!request.cursor.empty() && !is_ulid(request.cursor)) return tl::unexpected(bad_cursor());
  return parts_.store.read([&]() -> Answer<Page<Job>> {
    Page<Job> page;
    std::string looked_to;
    std::vector<JobRow> rows = jobs_.list(filter, request.cursor, request.limit + 1, looked_to);
    const bool more = rows.size() > static_cast<std::size_t>(request.limit);
    if (more) rows.pop_back();
    page.items.reserve(rows.size());
    for (const JobRow& row : rows) page.items.push_back(shown(row));
    page.next_cursor = more ? rows.back().id : looked_to;
    return page;
  });
}

Answer<Page<Job>> JobRepository::queue(const std::string& device, const PageRequest& request) {
  constexpr int kMostRead = 2000;  // rows that one request reads
  std::optional<QueuePlace> after;
  if (!request.cursor.empty()) {
    after = queue_place_from(request.cursor);
    if (!after) return tl::unexpected(bad_cursor());
  }
  return parts_.store.read([&]() -> Answer<Page<Job>> {
    Page<Job> page;
    std::map<std::string, bool> fits;  // by plan, because many jobs share a plan
    const auto fitting = [&](const JobRow& row) {
      if (device.empty() || !row.device.empty()) return true;
      if (!parts_.devices.wrong_site(device, row.site).empty()) return false;
      if (row.sheets_total == 0) return true;
      const auto [known, is_new] = fits.try_emplace(row.plan, true);
      if (is_new) {
        const auto plan = parts_.plans.table().find(row.plan);
        known->second = !plan || parts_.devices.misfit(device, *plan, "").empty();
      }
      return known->second;
    };
    for (int read = 0; read < kMostRead; read += request.limit + 1) {
      const JobTable::QueueSlice slice = jobs_.queue(device, after, request.limit + 1);
      for (const JobRow& row : slice.jobs) {
        if (page.items.size() == static_cast<std::size_t>(request.limit)) {
          page.next_cursor = text_of(*after);
          return page;
        }
        after = QueuePlace{row.priority, row.position, row.id};
        if (fitting(row)) page.items.push_back(shown(row));
      }
      if (slice.is_end) return page;
      after = slice.last;
    }
    page.next_cursor = text_of(*after);
    return page;
  });
}

Answer<Job> JobRepository::find(const std::string& id) {
  return parts_.store.read([&]() -> Answer<Job> {
    return row(id).map([&](const JobRow& found) {
      Job job = shown(found);
      const std::vector<Warning> changed = changed_since_planned(found);
      for (const Warning& one : changed) job.unaccepted.push_back(one.code);
      job.warnings.insert(job.warnings.begin(), changed.begin(), changed.end());
      const bool may_go_on =
          !changed.empty() || found.state == JobState::Interrupted ||
          (found.state == JobState::Ready &&
           (found.segment > 1 || !parts_.devices.remedies(found.requested_device).empty()));
      if (may_go_on && next_actions) job.next_actions = next_actions(found);
      return job;
    });
  });
}

Answer<Job> JobRepository::brief(const std::string& id) {
  return parts_.store.read([&]() -> Answer<Job> {
    return row(id).map([&](const JobRow& found) { return shown(found); });
  });
}

Answer<std::vector<SheetRecord>> JobRepository::sheets(const std::string& id, int first, int most) {
  return parts_.store.read([&]() -> Answer<std::vector<SheetRecord>> {
    const Answer<JobRow> job = row(id);
    if (!job) return tl::unexpected(job.error());
    std::vector<SheetRecord> all;
    const int count = job->sheets_total / std::max(1, job->copies);
    const int last = std::min({job->sheets_total, first + kSheetsAtOnce - 1, first + most - 1});
    for (int k = std::max(first, 1); k <= last; ++k) {
      const auto plan = parts_.plans.table().sheet(job->plan, plan_sheet(*job, k, count));
      if (!plan) break;
      SheetRecord record{.number = k, .copy = (k - 1) / count + 1, .state = "waiting"};
      record.plan = *plan;
      record.plan.number = k;
      all.push_back(std::move(record));
    }
    if (all.empty()) return all;
    const int begin = all.front().number;
    for (const AttemptTable::SheetRow& seen : attempts_.sheets(id, begin, all.back().number)) {
      SheetRecord& record = all[static_cast<std::size_t>(seen.sheet - begin)];
      record.blank = seen.blank;
      record.segment = seen.segment;
      record.state = seen.state;
      record.started = seen.started;
      record.finished = seen.finished;
    }
    return all;
  });
}

Answer<Ledger> JobRepository::ledger(const std::string& id, int sheet) {
  return parts_.store.read([&]() -> Answer<Ledger> {
    const Answer<JobRow> job = row(id);
    if (!job) return tl::unexpected(job.error());
    if (sheet < 1 || sheet > job->sheets_total)
      return refuse(ProblemKind::NotFound, fmt::format("job {} has no sheet {}; it has {} sheets",
                                                       id, sheet, job->sheets_total));
    const int count = job->sheets_total / std::max(1, job->copies);
    const auto plan = parts_.plans.table().sheet(job->plan, plan_sheet(*job, sheet, count));
    const auto seen = attempts_.sheet(id, sheet);
    Ledger ledger{
        .sheet = sheet, .blank = seen ? seen->blank : 1, .segment = seen ? seen->segment : 1};
    std::vector<std::vector<FateRun>> fates;
    std::int64_t strokes = plan ? plan->paths : 0;
    for (const AttemptRow& row : attempts_.of_sheet(id, sheet)) {
      ledger.attempts.push_back({.id = row.id,
                                 .blank = row.blank,
                                 .segment = row.segment,
                                 .started = row.started.value_or(row.created),
                                 .ended = row.ended,
                                 .end_kind = row.end_kind,
                                 .operator_name = row.operator_name,
                                 .bytes_taken = row.bytes_taken});
      if (row.blank != ledger.blank) continue;
      strokes = row.strokes;
      ledger.last_status = row.last_status;
      fates.push_back(attempts_.fates(row.id));
    }
    fill_ledger(ledger, merged_fates(strokes, fates));
    return ledger;
  });
}

}  // namespace popcut::daemon
