// SPDX-License-Identifier: MIT
#include "daemon/service/repositories/recovery.hpp"

#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "daemon/service/repositories/reports.hpp"

namespace popcut::daemon {
namespace {

// How long journals are kept in a fleet. If somebody restores an older copy of the database than
// that, they must look at the cutters themselves.
constexpr std::int64_t kJournals_ms = 30LL * 86'400'000;

std::string crash_text(const std::string& job, const std::string& loss) {
  return fmt::format(
      "popcutd ended during the cut; 'popcut jobs {}' shows which paths are in doubt{}", job,
      loss.empty() ? loss : fmt::format(" ({})", loss));
}

// A loss that begins with "the database" would only repeat the first part of this text.
std::string forgotten_text(const std::string& job, const std::string& loss) {
  return fmt::format(
      "the database went back to before this sheet was started; look at the sheet: 'popcut jobs "
      "{}' "
      "shows which paths may have been cut{}",
      job, loss.empty() || loss.starts_with("the database") ? "" : fmt::format(" ({})", loss));
}

class Recovery {
 public:
  Recovery(ServiceStore& store, JobRepository& jobs, IntentJournals& intents,
           std::function<bool(const std::string&)> cuts)
      : store_(store),
        jobs_(jobs),
        intents_(intents),
        cuts_(std::move(cuts)),
        trails_(intents.trails()) {
    // An attempt that is cut now needs no recovery, unless the database forgot its start.
    std::erase_if(trails_, [&](const auto& one) {
      return is_cut(one.first) && jobs_.attempts().knows(one.first);
    });
  }

  Answer<void> run() {
    close_attempts();
    jobs_.attempts().disarm_all();
    note_known();
    for (const auto& [attempt, trail] : trails_) try_to_handle_trail(attempt, trail);
    for (const JobState state :
         {JobState::Cutting, JobState::Paused, JobState::Armed, JobState::Planning})
      restart(state);
    store_.after_commit([this] {
      for (const std::string& attempt : ended_) intents_.ended(attempt);
      for (const std::string& attempt : outlived_) intents_.outlived(attempt);
      for (const std::string& attempt : empty_) intents_.remove(attempt);
      for (const auto& [job, why] : blocked_) intents_.block(job, why);
    });
    return {};
  }

 private:
  [[nodiscard]] bool is_cut(const std::string& attempt) const { return cuts_ && cuts_(attempt); }

  // In a fleet a journal that contradicts the database must not stop the recovery, because nobody
  // can arm until each node has compared its journals.
  void try_to_handle_trail(const std::string& attempt, const IntentTrail& trail) {
    if (!store_.in_fleet()) return handle_trail(attempt, trail);
    try {
      Transaction part(store_.db());
      handle_trail(attempt, trail);
      store_.db().script("SET CONSTRAINTS ALL IMMEDIATE; SET CONSTRAINTS ALL DEFERRED");
      part.commit();
    } catch (const StoreFault& fault) {
      if (fault.kind() != FaultKind::Constraint && fault.kind() != FaultKind::Refused) throw;
      store_.log(
          fmt::format("the journal {} does not fit the database: {}; look at the sheets in "
                      "the cutters before you start one",
                      attempt, fault.what()));
      note_journal(attempt, "does not fit");
    }
  }

  // Whether an attempt belongs to another state folder, of which this one is a copy. The journal in
  // that folder may say more.
  [[nodiscard]] bool is_foreign(const std::string& invocation) const {
    return store_.in_fleet() && !invocation.starts_with(store_.node().mark());
  }

  static IntentClaims claims_of(const IntentTrail& trail, std::int64_t first, std::int64_t strokes,
                                std::int64_t recorded) {
    return {.first = first,
            .strokes = strokes,
            .recorded = recorded,
            .journal = trail.journal,
            .witness = trail.witness};
  }

  // Ends the attempts that the database calls open and that are not cut now.
  void close_attempts() {
    AttemptTable& attempts = jobs_.attempts();
    for (const AttemptRow& open : attempts.open()) {
      if (is_cut(open.id)) {
        attempts.go_on(open.id);
        continue;
      }
      IntentTrail trail;
      if (const auto found = trails_.extract(open.id)) trail = found.mapped();
      const IntentVerdict verdict = verdict_of(open, trail);
      attempts.crash(open, store_.now(), verdict.doubt_upto, verdict.loss,
                     is_foreign(open.invocation) ? "lost" : "crash");
      ended_.push_back(open.id);
      Answer<JobRow> row = jobs_.row(open.job);
      if (!verdict.loss.empty())
        report_loss(open.job, open.sheet, verdict.loss, open.first_stroke, verdict.doubt_upto);
      if (!row || is_terminal(row->state)) continue;
      jobs_.count_paths(*row, open.sheet, open.blank, open.strokes);
      jobs_.table().update(*row);
      record_usage(
          store_, *row,
          {.operator_name = open.operator_name, .device = open.device, .sheet = open.sheet});
    }
  }

  // In a fleet the database normally knows less than the journal, because it gets marks only when
  // it answers. So that is no loss. But a copied journal may know less than the original.
  IntentVerdict verdict_of(const AttemptRow& attempt, const IntentTrail& trail) {
    // If another node called the attempt lost, it put all other strokes in doubt. Only the certain
    // ones are from this node.
    std::int64_t recorded = -1;
    if (attempt.end_kind != "lost")
      recorded = jobs_.attempts().last_recorded(attempt.id);
    else
      for (const FateRun& run : jobs_.attempts().fates(attempt.id))
        if (run.fate == PathFate::Certain) recorded = std::max(recorded, run.paths.last);
    if (store_.in_fleet()) recorded = std::max(recorded, trail.witness.last_before);
    IntentVerdict verdict =
        verdict_on(claims_of(trail, attempt.first_stroke, attempt.strokes, recorded));
    if (is_foreign(attempt.invocation)) {
      verdict.doubt_upto = attempt.strokes - 1;
      verdict.loss = "the journal of this cut is on another machine, or in another folder";
    }
    return verdict;
  }

  // Another node called this attempt lost and put all its strokes in doubt. Replaces that by what
  // the journal of this node says.
  void use_own_journal(const AttemptRow& lost, const IntentTrail& trail) {
    const IntentVerdict verdict = verdict_of(lost, trail);
    jobs_.attempts().crash(lost, store_.now(), verdict.doubt_upto, verdict.loss);
    Answer<JobRow> row = jobs_.row(lost.job);
    if (!row || row->state != JobState::Interrupted || row->sheet != lost.sheet ||
        row->blank != lost.blank)
      return;
    jobs_.count_paths(*row, lost.sheet, lost.blank, lost.strokes);
    jobs_.set_attention(*row, "in_doubt", crash_text(row->id, verdict.loss));
    row->reason = "crash";
    jobs_.save(*row);
  }

  // Drops the journals whose attempts the database knows and nobody called lost. One query finds
  // all of them, because a fleet keeps journals for a month, and each query takes time on the
  // network.
  void note_known() {
    if (!store_.in_fleet()) return;
    std::vector<std::string> ids;
    for (const auto& [attempt, trail] : trails_) ids.push_back(attempt);
    for (const auto& [id, created] : jobs_.attempts().known_among(ids)) {
      note_ended(id, created);
      trails_.erase(id);
    }
  }

  void note_ended(const std::string& attempt, TimeMs created) {
    ended_.push_back(attempt);
    if (store_.in_fleet() && created < store_.now() - kJournals_ms) outlived_.push_back(attempt);
  }

  // Handles the journal of an attempt that has ended, or that the database does not know. The
  // latter is restored if strokes may have been sent, and interrupts its job.
  void handle_trail(const std::string& attempt, const IntentTrail& trail) {
    if (const auto known = jobs_.attempts().find(attempt)) {
      if (known->end_kind == "lost") use_own_journal(*known, trail);
      return note_ended(attempt, known->created);
    }
    if (!trail.head) {
      store_.log(
          fmt::format("the journal {} is damaged and belongs to no attempt that is known; "
                      "look at the sheets in the cutters before you start one",
                      attempt));
      note_journal(attempt, "damaged");
      return;
    }
    const IntentHead& head = *trail.head;
    IntentVerdict verdict =
        verdict_on(claims_of(trail, head.first_stroke, head.strokes, head.first_stroke - 1));
    // No intent is recorded, so nothing was sent: the START was never committed.
    const bool goes_on = is_cut(attempt);
    if (!goes_on && verdict.doubt_upto < head.first_stroke) return empty_.push_back(attempt);
    const std::string lost = "the database does not know that this sheet was started",
                      beside = verdict.loss;
    verdict.loss = verdict.loss.empty() ? lost : lost + "; " + verdict.loss;
    const bool is_copy = is_foreign(head.invocation);
    if (is_copy) verdict.doubt_upto = head.strokes - 1;
    Answer<JobRow> found = jobs_.row(head.job);
    if (!found) {
      store_.log(
          fmt::format("paths {}..{} of sheet {} of job {} may have been cut on {}, but the "
                      "database does not know this job",
                      head.first_stroke, verdict.doubt_upto, head.sheet, head.job, head.device));
      note_journal(attempt, "unknown job " + head.job);
      return;
    }
    JobRow& row = *found;
    Surfacing surfacing =
        surfacing_of(row.state, {row.sheet, row.blank}, row.sheets_total, {head.sheet, head.blank});
    // If the database knows a later part of this blank, or if another node cuts this job now, the
    // job keeps its state, and the attempt only becomes a part of its history.
    const bool is_earlier = row.sheet == head.sheet && row.blank == head.blank &&
                            row.segment > std::max(1, head.segment);
    if (store_.in_fleet() && (is_earlier || is_cut_elsewhere(row)) &&
        surfacing != Surfacing::Blocks)
      surfacing = Surfacing::History;
    report_loss(head.job, head.sheet, verdict.loss, head.first_stroke, verdict.doubt_upto);
    if (surfacing == Surfacing::Blocks) {
      blocked_[head.job] = fmt::format(
          "sheet {} of this job was started, but popcutd lost its record of that; cancel this job "
          "and create it again, and use a new blank",
          head.sheet);
      return;
    }
    const bool is_history = surfacing == Surfacing::History;
    bring_back(head, verdict,
               goes_on   ? (surfacing == Surfacing::Interrupts ? "lost" : "superseded")
               : is_copy ? "lost"
                         : "crash");
    ended_.push_back(attempt);
    if (is_history) return;
    if (surfacing == Surfacing::InterruptsBefore) {
      const auto plan = jobs_.current_sheet(row);
      IntentHead before = head;
      before.attempt = store_.new_id();
      before.sheet = row.sheet;
      before.blank = row.blank;
      before.segment = row.segment;
      before.first_stroke = 0;
      before.strokes = plan ? plan->paths : head.strokes;
      bring_back(
          before,
          {before.strokes - 1,
           fmt::format("sheet {} was started later, so this one may have been cut", head.sheet)},
          "crash");
    } else {
      row.blank = head.blank;
      row.segment = std::max(1, head.segment);
      row.first_stroke = head.first_stroke;
    }
    row.device = head.device;
    row.operator_name = head.operator_name;
    jobs_.count_paths(row, row.sheet, row.blank, head.strokes);
    const std::string from(name_of(row.state));
    jobs_.set_attention(row, "in_doubt", forgotten_text(row.id, beside));
    // If it is cut here now, call it lost: `RunningCuts::reclaim`, which follows, takes it back.
    jobs_.apply_or_cancel(row, step_of(row.state, JobEvent::IntentsSurface),
                          goes_on ? "lost" : "crash");
    note_recovered(row, from);
  }

  // Restores the attempt, with all strokes in doubt that may have been sent.
  void bring_back(const IntentHead& head, const IntentVerdict& verdict, const char* end_kind) {
    AttemptTable& attempts = jobs_.attempts();
    bool started = true;  // the database allows one start of a blank and segment
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
        .node = store_.node().name,
        .epoch = store_.node().epoch,
        .identity = store_.node().identity,
    };
    attempts.bring_back(row, store_.now(), verdict.doubt_upto, verdict.loss, end_kind);
  }

  void report_loss(const std::string& job, int sheet, const std::string& loss, std::int64_t first,
                   std::int64_t last) {
    losses_[job] = loss;
    store_.log(fmt::format("job {} sheet {}: {}; paths {}..{} count as in doubt unless certain",
                           job, sheet, loss, first, last));
    store_.emit(
        "notice", job,
        JsonObject().number("sheet", sheet).text("state", "records disagree").text("detail", loss));
  }

  void note_journal(const std::string& attempt, const std::string& state) {
    store_.emit("notice", "", JsonObject().text("journal", attempt).text("state", state));
  }

  void note_recovered(const JobRow& row, const std::string& from) {
    store_.emit(
        "job", row.id,
        JsonObject()
            .text("state", name_of(row.state))
            .number("rev", row.rev)
            .object("recovered", JsonObject().text("from", from).text("to", name_of(row.state))));
    store_.log(
        fmt::format("job {}: {} after a restart, it was {}", row.id, name_of(row.state), from));
  }

  void restart(JobState state) {
    if (store_.in_fleet()) return restart_own(state);
    JobFilter filter;
    filter.states = {state};
    // `list` looks at a part of the jobs and says where to continue. Jobs that were restarted left
    // this state, so after a full page it finds the next ones from the beginning.
    std::string looked_to;
    for (;;) {
      const std::string after = looked_to;
      std::vector<JobRow> rows = jobs_.table().list(filter, after, 100, looked_to);
      if (rows.empty() && looked_to.empty()) return;
      for (JobRow& row : rows) restart(row);
    }
  }

  // The same in a fleet: only for jobs in the cutters of this node and jobs whose plans it made,
  // and not for jobs that it cuts now.
  void restart_own(JobState state) {
    const char* const sql =
        state == JobState::Planning
            ? "SELECT job.id FROM job JOIN plan ON plan.id=job.plan WHERE job.state=? AND "
              "(plan.planner='' OR plan.planner=?)"
            : "SELECT job.id FROM job JOIN device ON device.id=job.device WHERE job.state=? AND "
              "device.node=? AND NOT EXISTS (SELECT 1 FROM attempt WHERE attempt.job=job.id AND "
              "started_at IS NOT NULL AND ended IS NULL)";
    for (const std::string& id :
         all_of(store_.db().rows(sql, name_of(state), store_.node().name), first_text))
      if (Answer<JobRow> row = jobs_.row(id)) restart(*row);
    if (state == JobState::Planning) {
      store_.db().run(
          "UPDATE plan SET planner='', planner_epoch=0 WHERE planner=? AND state='pending'",
          store_.node().name);
      store_.db().run(
          "UPDATE search SET planner='', planner_epoch=0 WHERE planner=? AND state='pending'",
          store_.node().name);
    }
  }

  void restart(JobRow& row) {
    const std::string from(name_of(row.state));
    const Step step = step_of(row.state, JobEvent::Restarts);
    const bool interrupted = step == Step::ToInterrupted;
    const auto loss = losses_.find(row.id);
    if (interrupted)
      jobs_.set_attention(row, "in_doubt",
                          crash_text(row.id, loss == losses_.end() ? "" : loss->second));
    jobs_.apply_or_cancel(row, step, interrupted ? "crash" : "restart");
    note_recovered(row, from);
  }

  // Whether another node cuts the job, or has not recorded the end yet.
  [[nodiscard]] bool is_cut_elsewhere(const JobRow& row) {
    return store_.db().number(
               "SELECT EXISTS(SELECT 1 FROM attempt WHERE job=? AND node!=? AND started_at IS NOT "
               "NULL AND ended IS NULL)",
               row.id, store_.node().name) != 0;
  }

  ServiceStore& store_;
  JobRepository& jobs_;
  IntentJournals& intents_;
  std::function<bool(const std::string&)> cuts_;
  std::map<std::string, IntentTrail> trails_;            ///< by attempt; those not handled yet
  std::map<std::string, std::string> losses_, blocked_;  ///< by job
  std::vector<std::string> ended_, empty_, outlived_;
};

}  // namespace

Answer<void> recover(ServiceStore& store, JobRepository& jobs, IntentJournals& intents,
                     const std::function<bool(const std::string& attempt)>& cuts) {
  // On a full disk this runs twice, so begin with a new object each time.
  std::unique_ptr<Recovery> recovery;
  return store.change([&]() -> Answer<void> {
    recovery = std::make_unique<Recovery>(store, jobs, intents, cuts);
    return recovery->run();
  });
}

Answer<void> close_lost_node(ServiceStore& store, JobRepository& jobs, const std::string& node,
                             std::int64_t epoch) {
  return store.change([&]() -> Answer<void> {
    AttemptTable& attempts = jobs.attempts();
    const std::string why = fmt::format("node {} does not answer", node);
    for (const AttemptRow& open : attempts.open_of(node, epoch)) {
      attempts.crash(open, store.now(), open.strokes - 1, why, "lost");
      Answer<JobRow> row = jobs.row(open.job);
      if (!row || is_terminal(row->state)) continue;
      jobs.count_paths(*row, open.sheet, open.blank, open.strokes);
      jobs.set_attention(
          *row, "in_doubt",
          fmt::format("node {} has not answered for a while, and may still be cutting this sheet; "
                      "look at {}; if the node comes back, it records what it knows",
                      node, open.device));
      jobs.apply_or_cancel(*row, step_of(row->state, JobEvent::CutBreaks), "lost");
    }
    for (const std::string& job : attempts.armed_by(node, epoch)) {
      attempts.disarm(job);
      Answer<JobRow> row = jobs.row(job);
      if (row && row->state == JobState::Armed)
        jobs.apply(*row, step_of(row->state, JobEvent::ArmLapses), "lost");
    }
    for (const std::string& id :
         all_of(store.db().rows("SELECT job.id FROM job JOIN plan ON plan.id=job.plan WHERE "
                                "job.state='planning' AND plan.planner=? AND plan.planner_epoch<=?",
                                node, epoch),
                first_text))
      if (Answer<JobRow> row = jobs.row(id))
        jobs.apply(*row, step_of(row->state, JobEvent::Restarts), "lost");
    store.db().run(
        "UPDATE plan SET planner='', planner_epoch=0 WHERE planner=? AND planner_epoch<=? AND "
        "state='pending'",
        node, epoch);
    store.db().run(
        "UPDATE search SET planner='', planner_epoch=0 WHERE planner=? AND planner_epoch<=? AND "
        "state='pending'",
        node, epoch);
    store.emit("notice", "", JsonObject().text("node", node).text("state", "lost"));
    return {};
  });
}

CutStanding reconcile(ServiceStore& store, JobRepository& jobs, const std::string& attempt,
                      bool held) {
  if (!store.in_fleet()) return CutStanding::Current;
  const auto known = jobs.attempts().find(attempt);
  if (!known) return CutStanding::Superseded;
  // Sets the job to cutting or paused, as the knife is. The database may have gone back to before
  // the pause or the resume.
  const auto follow_knife = [&](JobRow& row) {
    if (held && row.state == JobState::Cutting)
      jobs.apply(row, step_of(row.state, JobEvent::CutHeld), "");
    else if (!held && row.state == JobState::Paused)
      jobs.apply(row, Step::ToCutting, "");
  };
  if (!known->ended) {
    if (Answer<JobRow> row = jobs.row(known->job)) follow_knife(*row);
    return CutStanding::Current;
  }
  if (known->end_kind != "lost")
    return known->end_kind == "superseded" ? CutStanding::Superseded : CutStanding::Recorded;
  Answer<JobRow> row = jobs.row(known->job);
  // If a person has changed the job, it has another state, reason, sheet, blank or segment.
  const bool is_untouched = row && row->state == JobState::Interrupted && row->reason == "lost" &&
                            row->sheet == known->sheet && row->blank == known->blank &&
                            row->segment == known->segment;
  if (!is_untouched) return CutStanding::Superseded;
  jobs.attempts().go_on(attempt);
  row->device = known->device;
  jobs.apply(*row, step_of(row->state, JobEvent::CutFoundAgain), "");
  follow_knife(*row);
  return CutStanding::Current;
}

}  // namespace popcut::daemon
