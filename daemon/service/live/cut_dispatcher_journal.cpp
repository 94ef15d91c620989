// SPDX-License-Identifier: MIT
#include <algorithm>
#include <chrono>
#include <new>

#include <fmt/format.h>

#include "daemon/service/live/cut_verdict.hpp"
#include "daemon/service/live/running_cut.hpp"
#include "daemon/service/repositories/reports.hpp"

namespace popcut::daemon {
namespace {

constexpr std::int64_t kTellMs = 500;
constexpr std::int64_t kTellAgainMs = 1000;  // and the clock of `tick` adds as much: 2 s at most

constexpr double kBusySeconds = 5;  // longer than a cutter with a full buffer takes nothing

/// The kind of what a person should see to while a cut goes on.
std::string attention_meanwhile(const SessionProgress& progress) {
  if (progress.phase == SessionPhase::Paused || progress.asks) return "device_fault";
  return progress.mute_s >= kBusySeconds ? "device_busy" : "";
}
std::string text_of_attention(const SessionProgress& progress) {
  if (progress.phase == SessionPhase::Paused)
    return "paused at the machine's panel; continue there";
  if (progress.asks)
    return "the machine was paused at its panel and is ready now, and popcut cannot tell whether "
           "it went on; look at it: resume if it did, cancel if it was cancelled there";
  if (progress.mute_s < kBusySeconds) return "";
  return "the machine accepts no data; check whether it is jammed or waits for input at its panel";
}

Error given_up(const std::string& why) {
  return {ErrorKind::Unwritable, "", "the cut stops because it cannot be recorded: " + why};
}

}  // namespace

// Called on the cutter's thread.
class CutDispatcher::Journal final : public CutJournal {
 public:
  Journal(CutDispatcher& dispatcher, std::shared_ptr<Cut> cut)
      : dispatcher_(dispatcher),
        thread_(dispatcher.parts_.thread),
        alive_(dispatcher.parts_.alive),
        cut_(std::move(cut)) {}

  Result<void> intend(std::int64_t last_stroke) override {
    using Clock = std::chrono::steady_clock;
    Result<void> done = tl::unexpected(given_up("popcutd is stopping"));
    const Clock::time_point begun = Clock::now();
    try {
      // Here, not on the service's thread, which others wait for: first beside the database, then
      // in it, so that neither can lose its end unnoticed.
      if (const Result<void> beside = intend_beside(last_stroke); !beside) return beside;
      // In a fleet that is what counts: a network or a database that is away ends no cut.
      if (dispatcher_.parts_.store.in_fleet()) return mark_when_there(last_stroke);
      thread_.run(ServiceThread::Lane::Cutting, [&] {
        const auto here = alive_.lock();
        if (!here) return;
        note_wait();
        done = dispatcher_.intended(*cut_, last_stroke);
      });
    } catch (const std::exception& fault) {
      done = tl::unexpected(given_up(fault.what()));
    }
    waited_s_ = std::chrono::duration<double>(Clock::now() - begun).count();
    return done;
  }

  // Written with the next `intend`, with progress, or at the end: one commit a step. Lost in a
  // crash it leaves more in doubt, never less.
  Result<void> settle(std::int64_t certain, std::int64_t taken,
                      std::uint64_t bytes_taken) override {
    const std::lock_guard lock(cut_->mutex);
    cut_->settled_certain = std::max(cut_->settled_certain, certain);
    cut_->settled_taken = std::max(cut_->settled_taken, taken);
    cut_->settled_bytes = std::max(cut_->settled_bytes, bytes_taken);
    cut_->settled = true;
    return {};
  }

  void progress(const SessionProgress& progress) override {
    {
      const std::lock_guard lock(cut_->mutex);
      const bool waiting = cut_->progress.has_value();
      cut_->progress = progress;
      if (waiting) return;
    }
    thread_.post(ServiceThread::Lane::Cutting,
                 [dispatcher = &dispatcher_, cut = cut_, alive = alive_] {
                   const auto here = alive.lock();
                   if (!here) return;
                   std::optional<SessionProgress> latest;
                   {
                     const std::lock_guard lock(cut->mutex);
                     latest = std::exchange(cut->progress, std::nullopt);
                   }
                   if (latest && !cut->over) dispatcher->progressed(*cut, *latest);
                 });
  }

  void ended(const SessionEnd& end) override {
    try {
      thread_.run(ServiceThread::Lane::Cutting, [&] {
        const auto here = alive_.lock();
        if (!here) return;
        note_wait();
        dispatcher_.ended(cut_, end);
      });
    } catch (const std::exception&) {
      // Tried again by the tick.
      thread_.post(ServiceThread::Lane::Asking,
                   [dispatcher = &dispatcher_, cut = cut_, alive = alive_, end] {
                     if (const auto here = alive.lock()) dispatcher->late_.push_back({cut, end});
                   });
    }
  }

 private:
  Result<void> mark_when_there(std::int64_t last_stroke) {
    thread_.post(ServiceThread::Lane::Cutting,
                 [dispatcher = &dispatcher_, cut = cut_, alive = alive_, last_stroke] {
                   if (const auto here = alive.lock(); here && !cut->over)
                     (void)dispatcher->intended(*cut, last_stroke);
                 });
    return {};
  }

  Result<void> intend_beside(std::int64_t last_stroke) {
    for (bool again = true;; again = false) {
      try {
        cut_->intents->intend(last_stroke);
        return {};
      } catch (const StoreFault& fault) {
        bool may = false;
        thread_.run(ServiceThread::Lane::Cutting, [&] {
          if (const auto here = alive_.lock()) may = dispatcher_.unwritten(fault);
        });
        if (!again || !may) return tl::unexpected(given_up(fault.what()));
      }
    }
  }

  /// On the service's thread: how long the stream was held up the last time.
  void note_wait() {
    if (const auto waited = std::exchange(waited_s_, std::nullopt))
      dispatcher_.parts_.store.note_stream_wait(*waited);
  }

  CutDispatcher& dispatcher_;
  ServiceThread& thread_;
  std::weak_ptr<void> alive_;
  std::shared_ptr<Cut> cut_;
  std::optional<double> waited_s_{};
};

CutDispatcher::~CutDispatcher() = default;

const LiveCut* CutDispatcher::live(const std::string& job) const {
  const auto found = cuts_.find(job);
  return found == cuts_.end() ? nullptr : &found->second->live;
}

Answer<std::shared_ptr<CutDispatcher::Cut>> CutDispatcher::prepare(const JobRow& row) {
  const auto sheet = parts_.jobs.current_sheet(row);
  if (!sheet)
    return tl::unexpected(JobRepository::conflict(row, "the job's plan has no such sheet"));
  auto found = parts_.programs.find(row.id, parts_.plans.folder_of(row.plan), sheet->number);
  if (!found) {
    Problem reading{ProblemKind::Unavailable,
                    "the program of this sheet is large and still being read; start again in a "
                    "moment"};
    reading.retry_after_s = 1;
    return tl::unexpected(std::move(reading));
  }
  Result<ProgramShelf::Program>& stored = *found;
  // Arming it again would not help.
  const auto lost = [&](std::string detail) {
    Problem problem = JobRepository::conflict(row, std::move(detail));
    problem.next_actions = {{std::string(name_of(JobAction::Cancel)), "{}"}};
    return tl::unexpected(std::move(problem));
  };
  if (!stored)
    return lost("the stored program cannot be read; create the job again: " +
                message(stored.error()));
  // What was armed is what is cut: a stored program that changed is not.
  EncodedProgram* const program = &stored->stored.program;
  const bool same = stored->sha256 == sheet->program_sha256 &&
                    stored->stored.index_sha256 == sheet->index_sha256 &&
                    static_cast<int>(program->strokes.size()) == sheet->paths;
  if (!same)
    return lost("the stored program is not the one that was planned; create the job again");
  auto cut = std::make_shared<Cut>();
  cut->job = row.id;
  cut->owner = row.owner;
  cut->operator_name = row.operator_name;
  cut->device = row.device;
  cut->material = row.material;
  cut->sheet = row.sheet;
  cut->blank = row.blank;
  cut->first = row.first_stroke;
  cut->strokes = static_cast<std::int64_t>(program->strokes.size());
  cut->plan = *sheet;
  cut->dots = program->dots;
  cut->marks = {.first = cut->first,
                .certain = cut->first - 1,
                .taken = cut->first - 1,
                .intended = cut->first - 1};
  cut->attempt = parts_.store.new_id();
  cut->order = {.attempt = cut->attempt,
                .device = row.device,
                .program = std::move(*program),
                .area_mm = sheet->area_mm,
                .first_stroke = cut->first};
  return cut;
}

Answer<void> CutDispatcher::start(const Principal& who, JobRow& row, const ActionRequest&) {
  if (stopping_) return refuse(ProblemKind::Unavailable, "popcutd is stopping");
  if (const auto here = check_node(row.device); !here) return tl::unexpected(here.error());
  if (may_cut)
    if (const auto may = may_cut(); !may) return tl::unexpected(may.error());
  AttemptTable& attempts = parts_.jobs.attempts();
  const auto armed = attempts.armed(row.id);
  if (!armed || !arm_lives(row.id))
    return tl::unexpected(JobRepository::conflict(row, "arming has expired; disarm and arm again"));
  const auto plan = parts_.plans.table().find(row.plan);
  const ArmedHere& here = armed_here_.at(row.id);
  if (!plan || armed->sheet != row.sheet || armed->blank != row.blank ||
      here.segment != row.segment || here.first_stroke != row.first_stroke ||
      armed->device != row.device || armed->plan_sha256 != plan->sha256)
    return tl::unexpected(JobRepository::conflict(
        row, "the armed sheet is not the one that would be cut; disarm and arm again"));
  if (const auto fine = parts_.devices.usable(row.device); !fine)
    return tl::unexpected(fine.error());
  if (const std::string why = parts_.devices.misfit(row.device, *plan, row.site); !why.empty())
    return tl::unexpected(JobRepository::conflict(
        row, fmt::format("{} can no longer cut this: {}", row.device, why)));
  if (const auto known = check_place(row, row.device); !known) return tl::unexpected(known.error());
  if (const auto device = parts_.devices.find(row.device);
      device->state != "idle" && device->state != "attention")
    return tl::unexpected(JobRepository::conflict(
        row, fmt::format("{} is {}{}{}; start when it is idle", row.device, device->state,
                         device->reasons.empty() ? "" : ": ", fmt::join(device->reasons, ", "))));
  row.operator_name = who.name;
  const Answer<std::shared_ptr<Cut>> cut = prepare(row);
  if (!cut) return tl::unexpected(cut.error());
  const TimeMs now = parts_.store.now();
  starting_ = (*cut)->attempt;
  try {
    (*cut)->intents = parts_.intents.begin({.attempt = (*cut)->attempt,
                                            .job = row.id,
                                            .sheet = row.sheet,
                                            .blank = row.blank,
                                            .segment = row.segment,
                                            .first_stroke = (*cut)->first,
                                            .strokes = (*cut)->strokes,
                                            .device = row.device,
                                            .device_session = parts_.devices.session_of(row.device),
                                            .operator_name = who.name,
                                            .plan_sha256 = plan->sha256,
                                            .invocation = parts_.store.invocation(),
                                            .created = now});
    parts_.store.fenced(attempts.start({.id = (*cut)->attempt,
                                        .job = row.id,
                                        .sheet = row.sheet,
                                        .blank = row.blank,
                                        .segment = row.segment,
                                        .first_stroke = (*cut)->first,
                                        .strokes = (*cut)->strokes,
                                        .device = row.device,
                                        .device_session = parts_.devices.session_of(row.device),
                                        .operator_name = who.name,
                                        .plan_sha256 = plan->sha256,
                                        .invocation = parts_.store.invocation(),
                                        .created = now,
                                        .started = now}));
  } catch (const StoreFault& fault) {
    if (fault.kind() != FaultKind::Constraint) throw;
    Problem used = JobRepository::conflict(
        row, "this blank was started before; disarm it and use a new one with retry-sheet");
    used.next_actions = {{std::string(name_of(JobAction::Disarm)), "{}"}};
    return tl::unexpected(std::move(used));
  }
  parts_.jobs.take(row, Step::ToCutting, "");
  // The knife moves only after all this is on the disk; what follows the commit takes no memory
  // but within `hand_over`.
  auto mine = std::make_shared<std::map<std::string, std::shared_ptr<Cut>>>();
  mine->emplace(row.id, *cut);
  parts_.store.after_commit([this, cut = *cut, mine] {
    cut->intents->keep();
    starting_.clear();
    armed_here_.erase(cut->job);
    placed_.erase(cut->job);
    asked_from_.erase(cut->job);
    parts_.programs.forget(cut->job);
    cuts_.merge(*mine);
    hand_over(cut);
  });
  return {};
}

void CutDispatcher::hand_over(const std::shared_ptr<Cut>& cut) {
  try {
    // The answer to the START may have come so late that others think this node is lost.
    if (may_cut)
      if (const auto may = may_cut(); !may) {
        cut->refusal = may.error().detail;
        return record_refusal(cut);
      }
    auto journal = std::make_shared<Journal>(*this, cut);
    const Result<void> taken = parts_.cutters.cut(std::move(cut->order), std::move(journal));
    cut->order = {};
    if (taken) return;
    cut->refusal = message(taken.error());
  } catch (const std::bad_alloc&) {
    cut->refusal = "out of memory";  // so short that it needs none
  }
  record_refusal(cut);
}

// Not a byte of it was sent, so the same blank may be started again. What cannot be written now is
// tried again by the tick.
void CutDispatcher::record_refusal(const std::shared_ptr<Cut>& cut) {
  try {
    const Answer<void> recorded = parts_.store.change([&]() -> Answer<void> {
      // In a fleet others may have called it lost meanwhile, and a person may have acted on that.
      const bool is_ours = !parts_.store.in_fleet() || take_up_one(*cut);
      Answer<JobRow> row = parts_.jobs.row(cut->job);
      if (!row && !is_ours) return {};
      if (!row) return tl::unexpected(row.error());
      const auto known = parts_.jobs.attempts().find(cut->attempt);
      if (known && (!known->ended || known->end_kind == "lost"))
        parts_.jobs.attempts().never_started(cut->attempt, parts_.store.now());
      if (is_ours)
        parts_.jobs.take_left(*row, step_of(row->state, JobEvent::CutRefused), *cut->refusal);
      return {};
    });
    if (!recorded) return;
    parts_.intents.ended(cut->attempt);
    cuts_.erase(cut->job);
  } catch (const std::bad_alloc&) {  // the tick comes back to it
  }
}

bool CutDispatcher::unwritten(const StoreFault& fault) {
  parts_.store.note(fault);
  return fault.kind() == FaultKind::Full && parts_.store.folder().free_reserve();
}

Result<void> CutDispatcher::intended(Cut& cut, std::int64_t last) {
  name_turn("intent of a cut");
  if (parts_.store.degraded()) return tl::unexpected(given_up("the database failed"));
  std::uint64_t bytes = 0;
  AttemptMarks marks = cut.marks;
  {
    const std::lock_guard lock(cut.mutex);
    marks.certain = std::max(marks.certain, cut.settled_certain);
    marks.taken = std::max(marks.taken, cut.settled_taken);
    bytes = cut.settled_bytes;
    cut.settled = false;
  }
  marks.intended = std::max(marks.intended, last);
  const auto noted = [&] {
    cut.marks = marks;
    cut.live.certain = marks.certain + 1;
    cut.live.sent = std::max(marks.certain, marks.taken) + 1;
  };
  if (parts_.store.in_fleet()) {
    // The journal knows it. The database hears of it now and then, if it is there.
    noted();
    cut.unmarked = true;
    const std::int64_t now = parts_.store.monotonic();
    const auto between_ms = static_cast<std::int64_t>(parts_.options.fleet.mark_s * 1000);
    if (now - cut.marked_ms < between_ms || (may_cut && !may_cut())) return {};
    cut.marked_ms = now;
  }
  const Answer<void> done = parts_.store.change([&]() -> Answer<void> {
    parts_.jobs.attempts().mark(cut.attempt, marks, bytes);
    return {};
  });
  if (!done && !parts_.store.in_fleet()) return tl::unexpected(given_up(done.error().detail));
  if (done) cut.unmarked = false;
  noted();
  return {};
}

void CutDispatcher::progressed(Cut& cut, const SessionProgress& progress) {
  name_turn("progress of a cut");
  bool settled = false;
  {
    const std::lock_guard lock(cut.mutex);
    settled = cut.settled;
  }
  if (settled && !parts_.store.degraded()) (void)intended(cut, cut.marks.intended);
  cut.live.seconds_left = progress.seconds_left;
  cut.live.done = static_cast<std::int64_t>(progress.strokes_done);
  cut.told = progress;
  if (progress.strokes > 0)
    cut.live.cut_share =
        static_cast<double>(progress.strokes_done) / static_cast<double>(progress.strokes);
  const bool turned = std::exchange(cut.phase, progress.phase) != progress.phase;
  std::optional<JobRow> shown_row;
  const Answer<void> noted = parts_.store.look([&]() -> Answer<void> {
    Answer<JobRow> row = parts_.jobs.row(cut.job);
    if (!row) return tl::unexpected(row.error());
    const bool held = progress.phase == SessionPhase::Held &&
                      (row->asked == "pause" || progress.asks || cut.pause_asked) &&
                      row->state == JobState::Cutting;
    const std::string shown = attention_meanwhile(progress);
    if (held || shown != cut.shown) {
      const Answer<void> taken = parts_.store.change([&]() -> Answer<void> {
        if (held) parts_.jobs.take(*row, step_of(row->state, JobEvent::CutHeld), "");
        if (shown != cut.shown) {
          const bool panel = progress.phase == SessionPhase::Paused || progress.asks;
          row->reason = panel ? "panel_pause" : shown;
          parts_.jobs.set_attention(*row, shown, text_of_attention(progress));
          parts_.jobs.save(*row);
        }
        return {};
      });
      if (taken) cut.shown = shown;
      if (taken && held) cut.pause_asked = false;
    }
    shown_row = std::move(*row);
    return {};
  });
  const std::int64_t now = parts_.store.monotonic();
  if (!noted || (!turned && now - cut.told_ms < kTellMs)) return;
  publish_progress(cut, *shown_row);
}

// A cutter that says nothing for a while still gets its events: whoever watches sees that the
// line is alive.
void CutDispatcher::repeat_progress() {
  const std::int64_t now = parts_.store.monotonic();
  for (const auto& [job, cut] : cuts_) {
    if (cut->over || cut->told.strokes == 0 || now - cut->told_ms < kTellAgainMs) continue;
    (void)parts_.store.look([&, one = cut.get()]() -> Answer<void> {
      if (const Answer<JobRow> row = parts_.jobs.row(one->job)) publish_progress(*one, *row);
      return {};
    });
  }
}

void CutDispatcher::publish_progress(Cut& cut, const JobRow& row) {
  const SessionProgress& progress = cut.told;
  const std::array<double, 2> left_s = parts_.jobs.shown(row).remaining_s;
  cut.told_ms = parts_.store.monotonic();
  parts_.store.publish(
      {.seq = 0,
       .kind = "progress",
       .time = parts_.store.now(),
       .job = cut.job,
       .data = fmt::format(
           R"({{"seq":0,"kind":"progress","job":"{}","state":"{}","rev":{},"sheet":{},"phase":"{}","paths_certain":{},"paths_sent":{},"paths_done":{},"paths":{},"seconds_left":{:.1f},"remaining_s":[{:.1f},{:.1f}]}})",
           cut.job, name_of(row.state), row.rev, cut.sheet, name_of(progress.phase),
           cut.live.certain, cut.live.sent, progress.strokes_done, progress.strokes,
           std::max(0.0, progress.seconds_left), left_s[0], left_s[1])});
}

void CutDispatcher::ended(const std::shared_ptr<Cut>& cut, const SessionEnd& end) {
  name_turn("end of a cut");
  cut->over = true;
  const Answer<void> recorded =
      parts_.store.change([&]() -> Answer<void> { return record_end(*cut, end); });
  if (recorded) {
    parts_.intents.ended(cut->attempt);
    cuts_.erase(cut->job);
    return;
  }
  parts_.store.log(fmt::format("the end of job {} sheet {} could not be recorded yet: {}", cut->job,
                               cut->sheet, recorded.error().detail));
  // After a failed write nothing is written any more: a restart finds it cutting and says so.
  if (!parts_.store.degraded()) late_.push_back({cut, end});
}

Answer<void> CutDispatcher::record_end(Cut& cut, const SessionEnd& end) {
  if (parts_.store.in_fleet() && !take_up_one(cut)) {
    // The record of its strokes is true all the same. A database that went back so far that it does
    // not know the job has no place for it; the journal stays.
    if (!cut.superseded) return {};
    if (parts_.jobs.attempts().knows(cut.attempt))
      parts_.jobs.attempts().finish(cut.attempt, parts_.store.now(), "superseded",
                                    end.error ? message(*end.error) : "", cut.bytes_taken(),
                                    fate_runs(end.fates, cut.dots, cut.first, cut.strokes));
    parts_.store.emit("notice", cut.job,
                      fmt::format(R"("sheet":{},"state":"superseded")", cut.sheet));
    return {};
  }
  Answer<JobRow> row = parts_.jobs.row(cut.job);
  if (!row) return tl::unexpected(row.error());
  const std::vector<FateRun> runs = fate_runs(end.fates, cut.dots, cut.first, cut.strokes);
  CutVerdict verdict = verdict_on(end, runs, stopping_);
  const bool cancelled = cut.cancel_asked || row->asked == "cancel";
  if (cancelled && !verdict.complete) verdict.kind = "cancelled";
  AttemptTable& attempts = parts_.jobs.attempts();
  const TimeMs now = parts_.store.now();
  std::string status = end.error ? message(*end.error) : end.confirmed ? "ready" : "";
  for (const std::string& remark : end.remarks) status += (status.empty() ? "" : "; ") + remark;
  attempts.finish(cut.attempt, now, verdict.kind, status, cut.bytes_taken(), runs);
  std::int64_t certain = 0;
  for (const FateRun& run : runs)
    if (run.fate == PathFate::Certain) certain += run.paths.last - run.paths.first + 1;
  const double mm = cut.strokes == 0
                        ? 0
                        : (cut.plan.cut_mm + cut.plan.fold_mm) * static_cast<double>(certain) /
                              static_cast<double>(cut.strokes);
  record_usage(parts_.store, *row,
               {.operator_name = cut.operator_name,
                .device = cut.device,
                .sheet = cut.sheet,
                .seconds = end.seconds,
                .cut_mm = mm,
                .sheets = verdict.complete ? 1 : 0});
  parts_.devices.count_sheet(cut.device, mm, verdict.complete);

  JobRepository& jobs = parts_.jobs;
  std::vector<std::vector<FateRun>> fates;
  for (const AttemptRow& attempt : attempts.of_sheet(cut.job, cut.sheet))
    if (attempt.blank == cut.blank) fates.push_back(attempts.fates(attempt.id));
  row->paths_certain = row->paths_sent = 0;
  for (const FateRun& run : merged_fates(cut.strokes, fates)) {
    const std::int64_t count = run.paths.last - run.paths.first + 1;
    if (run.fate == PathFate::Certain) row->paths_certain += count;
    if (run.fate != PathFate::NotSent) row->paths_sent += count;
  }
  if (verdict.complete) {
    const std::string reason = cancelled ? row->reason : "";
    jobs.take(*row, step_of(row->state, JobEvent::CutCompletes), "");
    // A cancel that came after the last stroke of the last sheet came too late.
    if (cancelled && !is_terminal(row->state)) jobs.take(*row, Step::ToCancelled, reason);
  } else if (cancelled) {
    jobs.take(*row, step_of(row->state, JobEvent::CutStops), row->reason);
  } else {
    jobs.set_attention(*row, verdict.attention, verdict.text);
    jobs.take(
        *row,
        step_of(row->state, verdict.unconfirmed ? JobEvent::CutUnconfirmed : JobEvent::CutBreaks),
        verdict.kind);
  }
  return {};
}

}  // namespace popcut::daemon
