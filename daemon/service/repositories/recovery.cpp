// SPDX-License-Identifier: MIT
#include "daemon/service/repositories/recovery.hpp"

#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "daemon/service/repositories/reports.hpp"

namespace popcut::daemon {
namespace {

std::string crash_text(const std::string& job, const std::string& loss) {
  return fmt::format(
      "popcutd ended during the cut; 'popcut jobs {}' shows which paths are in doubt{}", job,
      loss.empty() ? loss : fmt::format(" ({})", loss));
}

class Recovery {
 public:
  Recovery(ServiceStore& store, JobRepository& jobs, IntentJournals& intents)
      : store_(store), jobs_(jobs), intents_(intents), trails_(intents.trails()) {}

  Answer<void> run() {
    close_attempts();
    jobs_.attempts().disarm_all();
    for (const auto& [attempt, trail] : trails_) surface(attempt, trail);
    for (const JobState state :
         {JobState::Cutting, JobState::Paused, JobState::Armed, JobState::Planning})
      restart(state);
    store_.after_commit([this] {
      for (const std::string& attempt : ended_) intents_.ended(attempt);
      for (const std::string& attempt : empty_) intents_.remove(attempt);
      for (const auto& [job, why] : blocked_) intents_.block(job, why);
    });
    return {};
  }

 private:
  static IntentClaims claims_of(const IntentTrail& trail, std::int64_t first, std::int64_t strokes,
                                std::int64_t recorded) {
    return {.first = first,
            .strokes = strokes,
            .recorded = recorded,
            .journal = trail.journal,
            .witness = trail.witness};
  }

  // The attempts that nobody ended, and what they leave of their jobs.
  void close_attempts() {
    AttemptTable& attempts = jobs_.attempts();
    for (const AttemptRow& open : attempts.open()) {
      IntentTrail trail;
      if (const auto found = trails_.extract(open.id)) trail = found.mapped();
      const IntentVerdict verdict = verdict_on(
          claims_of(trail, open.first_stroke, open.strokes, attempts.last_recorded(open.id)));
      attempts.crash(open, store_.now(), verdict.doubt_upto, verdict.loss);
      ended_.push_back(open.id);
      Answer<JobRow> row = jobs_.row(open.job);
      if (!verdict.loss.empty())
        tell(open.job, open.sheet, verdict.loss, open.first_stroke, verdict.doubt_upto);
      if (!row || is_terminal(row->state)) continue;
      count_paths(*row, open.sheet, open.blank, open.strokes);
      jobs_.table().update(*row);
      record_usage(
          store_, *row,
          {.operator_name = open.operator_name, .device = open.device, .sheet = open.sheet});
    }
  }

  // An attempt that is not open: it has ended, or the database does not know it.
  void surface(const std::string& attempt, const IntentTrail& trail) {
    if (jobs_.attempts().knows(attempt)) return ended_.push_back(attempt);
    if (!trail.head) {
      store_.log(
          fmt::format("the journal {} is damaged and belongs to no attempt that is known; "
                      "look at the sheets in the cutters before you start one",
                      attempt));
      store_.emit("notice", "", fmt::format(R"("journal":"{}","state":"damaged")", attempt));
      return;
    }
    const IntentHead& head = *trail.head;
    IntentVerdict verdict =
        verdict_on(claims_of(trail, head.first_stroke, head.strokes, head.first_stroke - 1));
    // Nothing was sent: the start was never committed.
    if (verdict.doubt_upto < head.first_stroke) return empty_.push_back(attempt);
    const std::string lost = "the database does not know that this sheet was started";
    verdict.loss = verdict.loss.empty() ? lost : lost + "; " + verdict.loss;
    Answer<JobRow> found = jobs_.row(head.job);
    if (!found) {
      store_.log(
          fmt::format("paths {}..{} of sheet {} of job {} may have been cut on {}, but the "
                      "database does not know this job",
                      head.first_stroke, verdict.doubt_upto, head.sheet, head.job, head.device));
      store_.emit("notice", "",
                  fmt::format(R"("journal":"{}","state":"unknown job {}")", attempt, head.job));
      return;
    }
    JobRow& row = *found;
    const Surfacing surfacing =
        surfacing_of(row.state, {row.sheet, row.blank}, row.sheets_total, {head.sheet, head.blank});
    tell(head.job, head.sheet, verdict.loss, head.first_stroke, verdict.doubt_upto);
    if (surfacing == Surfacing::Blocks) {
      blocked_[head.job] = fmt::format(
          "sheet {} of this job was started, but popcutd lost its record of that; cancel this job "
          "and create it again, and use a new blank",
          head.sheet);
      return;
    }
    bring_back(head, verdict);
    ended_.push_back(attempt);
    if (surfacing == Surfacing::History) return;
    if (surfacing == Surfacing::InterruptsBefore) {
      const auto plan = jobs_.current_sheet(row);
      IntentHead before = head;
      before.attempt = store_.new_id();
      before.sheet = row.sheet;
      before.blank = row.blank;
      before.segment = row.segment;
      before.first_stroke = 0;
      before.strokes = plan ? plan->paths : head.strokes;
      bring_back(before, {before.strokes - 1,
                          fmt::format("sheet {} was started later, so this one may have been cut",
                                      head.sheet)});
    } else {
      row.blank = head.blank;
      row.segment = std::max(1, head.segment);
      row.first_stroke = head.first_stroke;
    }
    row.device = head.device;
    row.operator_name = head.operator_name;
    count_paths(row, row.sheet, row.blank, head.strokes);
    const std::string from(name_of(row.state));
    jobs_.set_attention(row, "in_doubt", crash_text(row.id, verdict.loss));
    jobs_.take(row, step_of(row.state, JobEvent::IntentsSurface), "crash");
    note_recovered(row, from);
  }

  // The attempt as a row, all of it that may have been sent in doubt.
  void bring_back(const IntentHead& head, const IntentVerdict& verdict) {
    AttemptTable& attempts = jobs_.attempts();
    bool started = true;  // only one start of a blank and segment may be on record
    for (const AttemptRow& other : attempts.of_sheet(head.job, head.sheet))
      if (other.blank == head.blank && other.segment == head.segment && other.started)
        started = false;
    const AttemptRow row{
        .id = head.attempt,
        .job = head.job,
        .sheet = head.sheet,
        .blank = head.blank,
        .segment = head.segment,
        .first_stroke = head.first_stroke,
        .strokes = head.strokes,
        .device = head.device,
        .device_session = head.device_session,
        .operator_name = head.operator_name,
        .plan_sha256 = head.plan_sha256,
        .invocation = head.invocation,
        .created = head.created,
        .started = started ? std::optional(head.created) : std::nullopt,
    };
    attempts.bring_back(row, store_.now(), verdict.doubt_upto, verdict.loss);
  }

  void count_paths(JobRow& row, int sheet, int blank, std::int64_t strokes) {
    std::vector<std::vector<FateRun>> fates;
    for (const AttemptRow& attempt : jobs_.attempts().of_sheet(row.id, sheet))
      if (attempt.blank == blank) fates.push_back(jobs_.attempts().fates(attempt.id));
    row.paths_certain = row.paths_sent = 0;
    for (const FateRun& run : merged_fates(strokes, fates)) {
      const std::int64_t count = run.paths.last - run.paths.first + 1;
      if (run.fate == PathFate::Certain) row.paths_certain += count;
      if (run.fate != PathFate::NotSent) row.paths_sent += count;
    }
  }

  void tell(const std::string& job, int sheet, const std::string& loss, std::int64_t first,
            std::int64_t last) {
    losses_[job] = loss;
    store_.log(fmt::format("job {} sheet {}: {}; paths {}..{} count as in doubt unless certain",
                           job, sheet, loss, first, last));
    store_.emit("notice", job,
                fmt::format(R"("sheet":{},"state":"records disagree","detail":{})", sheet,
                            json_text(loss)));
  }

  void note_recovered(const JobRow& row, const std::string& from) {
    store_.emit("job", row.id,
                fmt::format(R"("state":"{}","rev":{},"recovered":{{"from":"{}","to":"{}"}})",
                            name_of(row.state), row.rev, from, name_of(row.state)));
    store_.log(
        fmt::format("job {}: {} after a restart, it was {}", row.id, name_of(row.state), from));
  }

  void restart(JobState state) {
    JobFilter filter;
    filter.states = {state};
    // Each leaves its state, so the next few are the first ones.
    std::string looked_to;
    for (;;) {
      const std::string after = looked_to;
      std::vector<JobRow> rows = jobs_.table().list(filter, after, 100, looked_to);
      if (rows.empty() && looked_to.empty()) return;
      for (JobRow& row : rows) {
        const std::string from(name_of(row.state));
        const Step step = step_of(row.state, JobEvent::Restarts);
        const bool interrupted = step == Step::ToInterrupted;
        const auto loss = losses_.find(row.id);
        if (interrupted)
          jobs_.set_attention(row, "in_doubt",
                              crash_text(row.id, loss == losses_.end() ? "" : loss->second));
        jobs_.take(row, step, interrupted ? "crash" : "restart");
        note_recovered(row, from);
      }
    }
  }

  ServiceStore& store_;
  JobRepository& jobs_;
  IntentJournals& intents_;
  std::map<std::string, IntentTrail> trails_;            ///< by attempt, those not looked at yet
  std::map<std::string, std::string> losses_, blocked_;  ///< by job
  std::vector<std::string> ended_, empty_;
};

}  // namespace

Answer<void> recover(ServiceStore& store, JobRepository& jobs, IntentJournals& intents) {
  // On a full disk it runs twice: nothing of the first time may stay.
  std::unique_ptr<Recovery> recovery;
  return store.change([&]() -> Answer<void> {
    recovery = std::make_unique<Recovery>(store, jobs, intents);
    return recovery->run();
  });
}

}  // namespace popcut::daemon
