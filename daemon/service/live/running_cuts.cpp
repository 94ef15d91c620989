// SPDX-License-Identifier: MIT
#include "daemon/service/live/running_cuts.hpp"

#include <algorithm>
#include <chrono>
#include <new>

#include <fmt/format.h>

#include "daemon/service/live/cut_verdict.hpp"
#include "daemon/service/repositories/recovery.hpp"
#include "daemon/service/repositories/reports.hpp"

namespace popcut::daemon {
namespace {

constexpr std::int64_t kPublishEvery_ms = 500;
// `tick` comes once a second, so that events are 2 s apart at most.
constexpr std::int64_t kRepeatAfter_ms = 1000;
// A working cutter with a full buffer accepts data again sooner.
constexpr double kBusy_s = 5;

bool is_paused_at_panel(const SessionProgress& progress) {
  return progress.phase == SessionPhase::Paused || progress.asks;
}

/// The kind of the attention that a cut needs while it goes on; empty if it needs none.
std::string attention_meanwhile(const SessionProgress& progress) {
  if (is_paused_at_panel(progress)) return "device_fault";
  return progress.mute_s >= kBusy_s ? "device_busy" : "";
}

std::string text_of_attention(const SessionProgress& progress) {
  if (progress.phase == SessionPhase::Paused)
    return "paused at the machine's panel; continue there";
  if (progress.asks)
    return "the machine was paused at its panel and is ready now, and popcut cannot tell whether "
           "the cut went on; look at it: resume if it went on, cancel if it was cancelled there";
  if (progress.mute_s < kBusy_s) return "";
  return "the machine accepts no data; check whether it is jammed or waits for input at its panel";
}

Error unrecordable(const std::string& why) {
  return {ErrorKind::Unwritable, "", "the cut stops because it cannot be recorded: " + why};
}

IntentHead head_of(const AttemptRow& row) {
  return {.attempt = row.id,
          .job = row.job,
          .sheet = row.sheet,
          .blank = row.blank,
          .segment = row.segment,
          .first_stroke = row.first_stroke,
          .strokes = row.strokes,
          .device = row.device,
          .device_session = row.device_session,
          .operator_name = row.operator_name,
          .plan_sha256 = row.plan_sha256,
          .invocation = row.invocation,
          .created = row.created};
}

}  // namespace

/// Records for the cutter's thread. It may outlive `RunningCuts`, so it uses `RunningCuts` only in
/// posted work, which does not run after that is gone.
class RunningCuts::Journal final : public CutJournal {
 public:
  Journal(RunningCuts& cuts, std::shared_ptr<Cut> cut)
      : cuts_(cuts),
        post_(cuts.parts_.post),
        is_in_fleet_(cuts.parts_.store.in_fleet()),
        cut_(std::move(cut)) {}

  Result<void> intend(std::int64_t last_stroke) override {
    using Clock = std::chrono::steady_clock;
    Result<void> done = tl::unexpected(unrecordable("popcutd is stopping"));
    const Clock::time_point begun = Clock::now();
    try {
      // Write the journal first, then the database: if either loses its last records in a crash,
      // the other one shows it. Write the journal on this thread, because the service's thread must
      // not wait for the disk longer than it has to.
      if (const Result<void> beside = intend_in_files(last_stroke); !beside) return beside;
      // In a fleet the journal is enough: a database that does not answer must not end a cut.
      if (is_in_fleet_) {
        post_([cuts = &cuts_, cut = cut_,
               last_stroke] { (void)cuts->record_intent(*cut, last_stroke); },
              Poster::Lane::Cutting);
        return {};
      }
      post_.run(Poster::Lane::Cutting, [&] {
        note_wait();
        done = cuts_.record_intent(*cut_, last_stroke);
      });
    } catch (const std::exception& fault) {
      done = tl::unexpected(unrecordable(fault.what()));
    }
    waited_s_ = std::chrono::duration<double>(Clock::now() - begun).count();
    return done;
  }

  // Only kept in memory. The next `intend`, the next progress or the end records it, so that it
  // needs no commit of its own. If a crash loses it, more strokes are in doubt, never fewer.
  Result<void> settle(std::int64_t certain, std::int64_t taken,
                      std::uint64_t bytes_taken) override {
    const std::lock_guard lock(cut_->mutex);
    Cut::Settled& settled = cut_->settled;
    settled = {.certain = std::max(settled.certain, certain),
               .taken = std::max(settled.taken, taken),
               .bytes = std::max(settled.bytes, bytes_taken),
               .is_new = true};
    return {};
  }

  void progress(const SessionProgress& progress) override {
    {
      const std::lock_guard lock(cut_->mutex);
      const bool is_waiting = cut_->news.has_value();
      cut_->news = progress;
      if (is_waiting) return;
    }
    post_(
        [cuts = &cuts_, cut = cut_] {
          std::optional<SessionProgress> latest;
          {
            const std::lock_guard lock(cut->mutex);
            latest = std::exchange(cut->news, std::nullopt);
          }
          Running* const running = cuts->find_running(cut->attempt.id);
          if (latest && running != nullptr) cuts->progressed(*running, *latest);
        },
        Poster::Lane::Cutting);
  }

  void ended(const SessionEnd& end) override {
    try {
      post_.run(Poster::Lane::Cutting, [&] {
        note_wait();
        cuts_.ended(cut_->attempt.id, end);
      });
    } catch (const std::exception&) {
      // Out of memory. Only change the state; `tick` records the end.
      post_([cuts = &cuts_, cut = cut_, end] {
        if (const Running* const running = cuts->find_running(cut->attempt.id))
          cuts->cuts_.at(cut->attempt.id) = to_ended(*running, end);
      });
    }
  }

 private:
  Result<void> intend_in_files(std::int64_t last_stroke) {
    for (bool again = true;; again = false) {
      try {
        cut_->intents->intend(last_stroke);
        return {};
      } catch (const StoreFault& fault) {
        bool may = false;
        post_.run(Poster::Lane::Cutting, [&] { may = cuts_.may_write_again(fault); });
        if (!again || !may) return tl::unexpected(unrecordable(fault.what()));
      }
    }
  }

  /// Adds to the metrics how long the cutter waited for the last `intend`. On the service's thread.
  void note_wait() {
    if (const auto waited = std::exchange(waited_s_, std::nullopt))
      cuts_.parts_.store.note_stream_wait(*waited);
  }

  RunningCuts& cuts_;
  Poster post_;
  bool is_in_fleet_;
  std::shared_ptr<Cut> cut_;
  std::optional<double> waited_s_{};
};

// 1. Look-ups.

Running* RunningCuts::find_running(const std::string& attempt) {
  const auto found = cuts_.find(attempt);
  return found == cuts_.end() ? nullptr : std::get_if<Running>(&found->second);
}

Running* RunningCuts::find_running_of(const std::string& job) {
  for (auto& [attempt, state] : cuts_)
    if (auto* const running = std::get_if<Running>(&state);
        running != nullptr && running->cut->attempt.job == job)
      return running;
  return nullptr;
}

template <typename State>
std::vector<std::string> RunningCuts::all_in() const {
  std::vector<std::string> attempts;
  for (const auto& [attempt, state] : cuts_)
    if (std::holds_alternative<State>(state)) attempts.push_back(attempt);
  return attempts;
}

const Cut* RunningCuts::of_job(const std::string& job) const {
  const Cut* latest = nullptr;
  for (const auto& [attempt, state] : cuts_)
    if (const Cut* const cut = cut_of(state); cut != nullptr && cut->attempt.job == job)
      latest = cut;
  return latest;
}

bool RunningCuts::has(const std::string& attempt) const {
  const auto found = cuts_.find(attempt);
  return found != cuts_.end() && cut_of(found->second) != nullptr;
}

bool RunningCuts::any() const {
  return std::any_of(cuts_.begin(), cuts_.end(),
                     [](const auto& one) { return cut_of(one.second) != nullptr; });
}

std::string RunningCuts::job_on(const std::string& device) const {
  for (const auto& [attempt, state] : cuts_)
    if (const Cut* const cut = cut_of(state); cut != nullptr && cut->attempt.device == device)
      return cut->attempt.job;
  return {};
}

// 2. START.

// Writes the journal, then the database; the knife comes last. After the commit, only `hand_over`
// allocates memory, because it can record that there is none.
void RunningCuts::start(std::shared_ptr<Cut> cut, CutOrder order) {
  const AttemptRow& attempt = cut->attempt;
  CutState& state = cuts_[attempt.id];
  state = InDoubt{};
  try {
    cut->intents = parts_.intents.begin(head_of(attempt));
    parts_.store.note_fence(parts_.jobs.attempts().start(attempt));
  } catch (const StoreFault& fault) {
    if (fault.kind() == FaultKind::Constraint) cuts_.erase(attempt.id);
    throw;
  }
  auto kept = std::make_shared<CutOrder>(std::move(order));
  parts_.store.after_commit([this, cut = std::move(cut), kept, &state] {
    cut->intents->keep();
    state = Running{.cut = cut};
    hand_over(cut->attempt.id, std::move(*kept));
  });
}

void RunningCuts::hand_over(const std::string& attempt, CutOrder order) {
  CutState& state = cuts_.at(attempt);
  const Running& running = std::get<Running>(state);
  std::string why;
  try {
    // The database may have answered so late that other nodes call this one lost.
    if (const auto may = may_cut(); !may) {
      why = may.error().detail;
    } else {
      auto journal = std::make_shared<Journal>(*this, running.cut);
      const Result<void> taken = parts_.cutters.cut(std::move(order), std::move(journal));
      if (taken) return;
      why = message(taken.error());
    }
  } catch (const std::bad_alloc&) {
    why = "out of memory";  // this text is so short that it needs no memory
  }
  state = to_refused(running, std::move(why));
  record_refusal(attempt);
}

// No byte was sent, so the same blank may be started again.
void RunningCuts::record_refusal(const std::string& attempt) {
  const Refused& refused = std::get<Refused>(cuts_.at(attempt));
  try {
    const Answer<void> recorded = parts_.store.change([&]() -> Answer<void> {
      AttemptTable& attempts = parts_.jobs.attempts();
      // In a fleet another node may have called the attempt lost, and a person may have changed the
      // job since.
      const bool is_ours =
          reconcile(parts_.store, parts_.jobs, attempt, false) == CutStanding::Current;
      Answer<JobRow> row = parts_.jobs.row(refused.cut->attempt.job);
      if (!row && !is_ours) return {};
      if (!row) return tl::unexpected(row.error());
      const auto known = attempts.find(attempt);
      if (known && (!known->ended || known->end_kind == "lost"))
        attempts.never_started(attempt, parts_.store.now());
      if (is_ours)
        parts_.jobs.apply_or_cancel(*row, step_of(row->state, JobEvent::CutRefused), refused.why);
      return {};
    });
    if (!recorded) return;  // `tick` tries again
    parts_.intents.ended(attempt);
    cuts_.erase(attempt);
  } catch (const std::bad_alloc&) {  // `tick` tries again
  }
}

bool RunningCuts::revoke_start(const AttemptRow& attempt) {
  const auto found = cuts_.find(attempt.id);
  if (found == cuts_.end() || !std::holds_alternative<InDoubt>(found->second) ||
      parts_.intents.has(attempt.id))
    return false;
  const Answer<void> noted = parts_.store.change([&]() -> Answer<void> {
    // Waits until the transaction of that START has ended.
    (void)parts_.store.db().number("SELECT rev FROM job WHERE id=? FOR UPDATE", attempt.job);
    const auto open = parts_.jobs.attempts().find(attempt.id);
    if (!open || open->ended) return {};
    Answer<JobRow> row = parts_.jobs.row(attempt.job);
    parts_.jobs.attempts().never_started(attempt.id, parts_.store.now());
    if (row && !is_terminal(row->state))
      parts_.jobs.apply_or_cancel(*row, step_of(row->state, JobEvent::CutRefused),
                                  "the database went away during the start; nothing was sent");
    return {};
  });
  if (noted) cuts_.erase(found);
  return true;
}

// 3. While it is cut.

bool RunningCuts::may_write_again(const StoreFault& fault) {
  parts_.store.handle_fault(fault);
  return fault.kind() == FaultKind::Full && parts_.store.folder().free_reserve();
}

Result<void> RunningCuts::record_intent(Cut& cut, std::int64_t last_stroke) {
  name_turn("intent of a cut");
  ServiceStore& store = parts_.store;
  if (store.degraded()) return tl::unexpected(unrecordable("the database failed"));
  if (find_running(cut.attempt.id) == nullptr) return tl::unexpected(unrecordable("it has ended"));
  AttemptMarks marks = cut.marks;
  Cut::Settled settled;
  {
    const std::lock_guard lock(cut.mutex);
    settled = cut.settled;
    cut.settled.is_new = false;
  }
  marks.certain = std::max(marks.certain, settled.certain);
  marks.taken = std::max(marks.taken, settled.taken);
  marks.intended = std::max(marks.intended, last_stroke);
  const auto note_marks = [&] {
    cut.marks = marks;
    cut.live.certain = marks.certain + 1;
    cut.live.sent = std::max(marks.certain, marks.taken) + 1;
  };
  const auto store_marks = [&] {
    return store.change([&]() -> Answer<void> {
      parts_.jobs.attempts().mark(cut.attempt.id, marks, settled.bytes);
      return {};
    });
  };
  if (!store.in_fleet()) {
    if (const Answer<void> done = store_marks(); !done)
      return tl::unexpected(unrecordable(done.error().detail));
    note_marks();
    return {};
  }
  // The journal has the intent. The database gets it every `mark_s` seconds, if it answers.
  note_marks();
  cut.is_unmarked = true;
  const std::int64_t now = store.monotonic();
  const auto between_ms = static_cast<std::int64_t>(parts_.options.fleet.mark_s * 1000);
  if (now - cut.marked_ms < between_ms || !may_cut()) return {};
  cut.marked_ms = now;
  if (store_marks()) cut.is_unmarked = false;
  return {};
}

void RunningCuts::progressed(Running& running, const SessionProgress& progress) {
  name_turn("progress of a cut");
  Cut& cut = *running.cut;
  bool is_new = false;
  {
    const std::lock_guard lock(cut.mutex);
    is_new = cut.settled.is_new;
  }
  if (is_new && !parts_.store.degraded()) (void)record_intent(cut, cut.marks.intended);
  cut.live.seconds_left = progress.seconds_left;
  cut.live.done = static_cast<std::int64_t>(progress.strokes_done);
  if (progress.strokes > 0)
    cut.live.cut_share =
        static_cast<double>(progress.strokes_done) / static_cast<double>(progress.strokes);
  const bool is_new_phase = std::exchange(running.progress, progress).phase != progress.phase;
  std::optional<JobRow> shown;
  const Answer<void> noted = parts_.store.read([&]() -> Answer<void> {
    Answer<JobRow> row = parts_.jobs.row(cut.attempt.job);
    if (!row) return tl::unexpected(row.error());
    record_progress(running, *row);
    shown = std::move(*row);
    return {};
  });
  const std::int64_t since_ms = parts_.store.monotonic() - running.published_ms;
  if (noted && (is_new_phase || since_ms >= kPublishEvery_ms)) publish(running, *shown);
}

// Changes and stores the job if the last progress says that the tool is up after a pause, or that
// the cut needs attention.
void RunningCuts::record_progress(Running& running, JobRow& row) {
  const SessionProgress& progress = running.progress;
  const auto begins_pause = [&](const JobRow& job) {
    return running.is_held() &&
           (job.asked == "pause" || progress.asks || running.is_pause_unrecorded) &&
           job.state == JobState::Cutting;
  };
  const std::string attention = attention_meanwhile(progress);
  if (!begins_pause(row) && attention == running.attention) return;
  std::optional<JobRow> changed;
  const Answer<void> stored = parts_.store.change([&]() -> Answer<void> {
    // Read the job again: on a full disk this runs twice, and another node may have changed the
    // job.
    Answer<JobRow> job = parts_.jobs.row(row.id);
    if (!job) return tl::unexpected(job.error());
    if (begins_pause(*job)) parts_.jobs.apply(*job, step_of(job->state, JobEvent::CutHeld), "");
    if (attention != running.attention) {
      job->reason = is_paused_at_panel(progress) ? "panel_pause" : attention;
      parts_.jobs.set_attention(*job, attention, text_of_attention(progress));
      parts_.jobs.save(*job);
    }
    changed = std::move(*job);
    return {};
  });
  if (!stored) {
    // No progress comes while the tool is up, so `tick` records the pause.
    if (begins_pause(row)) running.is_pause_unrecorded = true;
    return;
  }
  row = std::move(*changed);
  running.attention = attention;
  if (row.state == JobState::Paused) running.is_pause_unrecorded = false;
}

void RunningCuts::publish(Running& running, const JobRow& row) {
  const SessionProgress& progress = running.progress;
  const Cut& cut = *running.cut;
  running.published_ms = parts_.store.monotonic();
  parts_.store.publish({.seq = 0,
                        .kind = "progress",
                        .time = parts_.store.now(),
                        .job = cut.attempt.job,
                        .data = JsonObject()
                                    .number("seq", 0)
                                    .text("kind", "progress")
                                    .text("job", cut.attempt.job)
                                    .text("state", name_of(row.state))
                                    .number("rev", row.rev)
                                    .number("sheet", cut.attempt.sheet)
                                    .text("phase", name_of(progress.phase))
                                    .number("paths_certain", cut.live.certain)
                                    .number("paths_sent", cut.live.sent)
                                    .number("paths_done", progress.strokes_done)
                                    .number("paths", progress.strokes)
                                    .number("seconds_left", std::max(0.0, progress.seconds_left), 1)
                                    .pair("remaining_s", parts_.jobs.shown(row).est.remaining_s, 1)
                                    .whole()});
}

void RunningCuts::pause_unrecorded(const std::string& job) {
  Running* const running = find_running_of(job);
  if (running == nullptr) return;
  running->is_pause_unrecorded = true;
  parts_.cutters.pause(running->cut->attempt.device);
}

void RunningCuts::forget_pause(const std::string& job) {
  if (Running* const running = find_running_of(job)) running->is_pause_unrecorded = false;
}

void RunningCuts::cancel(const std::string& job, const std::string& device) {
  if (Running* const running = find_running_of(job)) running->is_cancelled = true;
  parts_.cutters.cancel(device);
}

// If the job cannot be read now, the next `tick` tries again.
void RunningCuts::apply_remote_request(const std::string& job) {
  Running* const running = find_running_of(job);
  if (running == nullptr) return;
  (void)parts_.store.read([&]() -> Answer<void> {
    const Answer<JobRow> row = parts_.jobs.row(job);
    if (!row) return {};
    const std::string& device = running->cut->attempt.device;
    if (row->asked == "cancel" && !running->is_cancelled) {
      running->is_cancelled = true;
      parts_.cutters.cancel(device);
    } else if (row->asked == "pause") {
      parts_.cutters.pause(device);
    }
    return {};
  });
}

void RunningCuts::stop_all() {
  for (const auto& [attempt, state] : cuts_)
    if (const auto* const running = std::get_if<Running>(&state))
      parts_.cutters.cancel(running->cut->attempt.device);
}

void RunningCuts::reclaim() {
  for (const std::string& attempt : all_in<Running>()) {
    const Running* const running = find_running(attempt);
    if (running == nullptr) continue;
    const AttemptRow& row = running->cut->attempt;
    CutStanding found = CutStanding::Current;
    const Answer<void> stored = parts_.store.change([&]() -> Answer<void> {
      found = reconcile(parts_.store, parts_.jobs, attempt, running->is_held());
      return {};
    });
    if (!stored || found != CutStanding::Superseded) continue;
    parts_.store.log(fmt::format(
        "job {} sheet {}: while this node did not answer, a person changed the job; the "
        "cut stops",
        row.job, row.sheet));
    parts_.cutters.cancel(row.device);
  }
}

void RunningCuts::tick() {
  const std::int64_t now = parts_.store.monotonic();
  // Publish events even if a cutter reports nothing for a while, so that clients see that their
  // connection works.
  for (auto& [attempt, state] : cuts_) {
    auto* const running = std::get_if<Running>(&state);
    if (running == nullptr || running->progress.strokes == 0 ||
        now - running->published_ms < kRepeatAfter_ms)
      continue;
    (void)parts_.store.read([&]() -> Answer<void> {
      if (const Answer<JobRow> row = parts_.jobs.row(running->cut->attempt.job))
        publish(*running, *row);
      return {};
    });
  }
  if (parts_.store.degraded()) return;
  for (const std::string& attempt : all_in<Running>())
    if (Running* const one = find_running(attempt); one->is_pause_unrecorded && one->is_held())
      progressed(*one, SessionProgress(one->progress));
  for (const std::string& attempt : all_in<Refused>()) record_refusal(attempt);
  // The event of a request at another node may have come while the database did not answer.
  if (parts_.store.in_fleet())
    for (const std::string& attempt : all_in<Running>())
      if (const Running* const one = find_running(attempt))
        apply_remote_request(std::string(one->cut->attempt.job));
  // A paused cut reports no progress, so store its marks here.
  for (const std::string& attempt : all_in<Running>())
    if (Cut& cut = *find_running(attempt)->cut; cut.is_unmarked)
      (void)record_intent(cut, cut.marks.intended);
  for (const std::string& attempt : all_in<Ended>()) try_to_record_end(attempt);
}

// 4. Its end.

void RunningCuts::ended(const std::string& attempt, const SessionEnd& end) {
  name_turn("end of a cut");
  const Running* const running = find_running(attempt);
  if (running == nullptr) return;
  cuts_.at(attempt) = to_ended(*running, end);
  try_to_record_end(attempt);
}

// If the database has failed, the end is never stored: the next start finds that the job is
// cutting, and interrupts it. After any other fault `tick` tries again.
void RunningCuts::try_to_record_end(const std::string& attempt) {
  Ended& ended = std::get<Ended>(cuts_.at(attempt));
  const Answer<void> recorded =
      parts_.store.change([&]() -> Answer<void> { return record_end(ended); });
  if (!recorded) {
    // Log each reason once, because `tick` may try for hours.
    const AttemptRow& row = ended.cut->attempt;
    const std::string& why = recorded.error().detail;
    if (std::exchange(ended.logged, why) != why)
      parts_.store.log(fmt::format("the end of job {} sheet {} could not be recorded yet: {}",
                                   row.job, row.sheet, why));
    return;
  }
  cuts_.erase(attempt);
  parts_.intents.ended(attempt);
}

Answer<void> RunningCuts::record_end(const Ended& ended) {
  Cut& cut = *ended.cut;
  const AttemptRow& attempt = cut.attempt;
  const SessionEnd& end = ended.end;
  switch (reconcile(parts_.store, parts_.jobs, attempt.id, ended.was_held)) {
    case CutStanding::Current:
      break;
    case CutStanding::Superseded:
      record_superseded(ended);
      return {};
    case CutStanding::Recorded:
      return {};
  }
  Answer<JobRow> row = parts_.jobs.row(attempt.job);
  if (!row) return tl::unexpected(row.error());
  const std::vector<FateRun> runs =
      fate_runs(end.fates, cut.dots, attempt.first_stroke, attempt.strokes);
  CutVerdict verdict = verdict_on(end, runs, is_stopping_);
  const bool is_cancelled = ended.is_cancelled || row->asked == "cancel";
  if (is_cancelled && !verdict.complete) verdict.kind = "cancelled";
  std::string status = end.error ? message(*end.error) : end.confirmed ? "ready" : "";
  for (const std::string& remark : end.remarks) status += (status.empty() ? "" : "; ") + remark;
  parts_.jobs.attempts().finish(attempt.id, parts_.store.now(), verdict.kind, status,
                                cut.bytes_taken(), runs);
  std::int64_t certain = 0;
  for (const FateRun& run : runs)
    if (run.fate == PathFate::Certain) certain += run.paths.last - run.paths.first + 1;
  const double cut_mm = attempt.strokes == 0 ? 0
                                             : cut.length_mm * static_cast<double>(certain) /
                                                   static_cast<double>(attempt.strokes);
  record_usage(parts_.store, *row,
               {.operator_name = attempt.operator_name,
                .device = attempt.device,
                .sheet = attempt.sheet,
                .seconds = end.seconds,
                .cut_mm = cut_mm,
                .sheets = verdict.complete ? 1 : 0});
  parts_.devices.count_sheet(attempt.device, cut_mm, verdict.complete);
  parts_.jobs.count_paths(*row, attempt.sheet, attempt.blank, attempt.strokes);
  change_job(*row, verdict, is_cancelled);
  return {};
}

// Stores the strokes, and does not change the job. If the database was restored and does not know
// the attempt, only the journal keeps them.
void RunningCuts::record_superseded(const Ended& ended) {
  const AttemptRow& attempt = ended.cut->attempt;
  const SessionEnd& end = ended.end;
  if (parts_.jobs.attempts().knows(attempt.id))
    parts_.jobs.attempts().finish(
        attempt.id, parts_.store.now(), "superseded", end.error ? message(*end.error) : "",
        ended.cut->bytes_taken(),
        fate_runs(end.fates, ended.cut->dots, attempt.first_stroke, attempt.strokes));
  parts_.store.emit("notice", attempt.job,
                    JsonObject().number("sheet", attempt.sheet).text("state", "superseded"));
}

void RunningCuts::change_job(JobRow& row, const CutVerdict& verdict, bool is_cancelled) {
  JobRepository& jobs = parts_.jobs;
  if (verdict.complete) {
    const std::string reason = is_cancelled ? row.reason : "";
    jobs.apply(row, step_of(row.state, JobEvent::CutCompletes), "");
    // If this was the last sheet, the job is done, and the cancel came too late.
    if (is_cancelled && !is_terminal(row.state)) jobs.apply(row, Step::ToCancelled, reason);
  } else if (is_cancelled) {
    jobs.apply(row, step_of(row.state, JobEvent::CutStops), row.reason);
  } else {
    jobs.set_attention(row, verdict.attention, verdict.text);
    jobs.apply(
        row,
        step_of(row.state, verdict.unconfirmed ? JobEvent::CutUnconfirmed : JobEvent::CutBreaks),
        verdict.kind);
  }
}

}  // namespace popcut::daemon
