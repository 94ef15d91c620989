// SPDX-License-Identifier: MIT
#include "tests/support/lease_protocol.hpp"

#include <algorithm>

namespace popcut::testing::lease {

bool Rules::newest(int p, Byte epoch) const {
  const Node& node = world_.now.nodes[at(node_of(p))];
  return epoch != 0 && (flaw_ == Flaw::EpochUnchecked || epoch == node.epoch) && node.begun != 0;
}

bool Rules::calls(int p) const {
  const Process& one = world_.processes[at(p)];
  return one.up != 0 && one.linked != 0 && newest(p, one.epoch);
}

bool Rules::reported() const {
  return std::all_of(world_.now.nodes.begin(), world_.now.nodes.end(),
                     [](const Node& node) { return node.owes == 0; });
}

bool Rules::works(int p) const {
  return calls(p) && world_.processes[at(p)].recovered != 0 &&
         world_.now.nodes[at(node_of(p))].lease == Lease::Live;
}

bool Rules::stands(int id) const {
  const Job& job = world_.now.job;
  const Attempt& one = world_.now.attempts[at(id)];
  if (!at_place(job, world_.made[at(id)])) return false;
  if (one.open != 0) return cuts(job);
  return one.end == End::Lost && job.state == JobState::Interrupted &&
         (job.not_good == 0 || flaw_ == Flaw::OverrulesNotGood);
}

void Rules::take(JobState state) {
  world_.now.job.state = state;
  world_.now.job.asked = Asked::Nothing;
  world_.now.job.arm = world_.now.job.arm_node = 0;
}

void Rules::next_sheet(bool said) {
  Job& job = world_.now.job;
  if (said) world_.now.said[at(job.sheet - 1)] = 1;
  take(daemon::state_after(job.state, daemon::Step::NextSheet, job.sheet, kSheets));
  job.not_good = job.all_doubt = 0;
  if (job.state != JobState::Ready) return;
  ++job.sheet;
  job.blank = job.segment = 1;
  job.first = 0;
  // A database that went back may know of attempts at a sheet that it has not come to.
  for (int id = 0; id < world_.next_id; ++id) {
    const Made& made = world_.made[at(id)];
    if (world_.now.attempts[at(id)].started == 0 || made.sheet != job.sheet) continue;
    job.state = JobState::Interrupted;
    if (made.blank > job.blank || (made.blank == job.blank && made.segment >= job.segment))
      go_to(made);
  }
}

void Rules::go_to(const Made& made) {
  Job& job = world_.now.job;
  job.blank = made.blank;
  job.segment = made.segment;
  job.first = made.first;
}

// What nobody cuts any more. A cancel that was asked for is not forgotten.
void Rules::interrupt() {
  const bool cancel = world_.now.job.asked == Asked::Cancel && flaw_ != Flaw::SweepForgetsCancel;
  take(cancel ? JobState::Cancelled : JobState::Interrupted);
}

void Rules::close(int id, End end, int doubt_upto) {
  Attempt& one = world_.now.attempts[at(id)];
  one.open = one.epoch = 0;
  one.end = end;
  for (int k = world_.made[at(id)].first; k < kStrokes; ++k)
    if (Byte& fate = one.fates[at(k)]; fate != kCertain) fate = k < doubt_upto ? kDoubt : kNotSent;
}

void Rules::lose(int id, End end, int doubt_upto) {
  const bool stood = stands(id);
  close(id, end, doubt_upto);
  if (stood) interrupt();
}

void Rules::mark(int id, int taken, int intended) {
  Attempt& one = world_.now.attempts[at(id)];
  for (int k = world_.made[at(id)].first; k < kStrokes; ++k) {
    const Byte says = k < taken ? kCertain : k < intended ? kDoubt : kNotSent;
    Byte& fate = one.fates[at(k)];
    fate = flaw_ == Flaw::MarkUnchecked ? says : std::max(fate, says);
  }
}

bool Rules::may_commit(int p, Byte epoch, int id) const {
  const Job& job = world_.now.job;
  const bool armed =
      job.state == JobState::Armed &&
      (job.arm == epoch || flaw_ == Flaw::ArmSurvivesRestart || flaw_ == Flaw::EpochUnchecked) &&
      job.arm_node == node_of(p) + 1;
  if (!newest(p, epoch) || world_.now.nodes[at(node_of(p))].lease != Lease::Live || !reported() ||
      !armed || !at_place(job, world_.made[at(id)]))
    return false;
  for (int other = 0; other < kAttempts; ++other) {
    const Attempt& one = world_.now.attempts[at(other)];
    if (one.present == 0) continue;
    if (other == id || one.open != 0) return false;
    if (one.started != 0 && at_place(job, world_.made[at(other)])) return false;
  }
  return true;
}

bool Rules::commit_start(int p, Byte epoch, int id) {
  if (!may_commit(p, epoch, id)) return false;
  if (world_.now.job.arm != epoch) broken_ = kOtherArm;
  if (world_.now.nodes[at(node_of(p))].epoch != epoch) broken_ = kOldEpoch;
  world_.now.attempts[at(id)] = {.present = 1, .started = 1, .open = 1, .epoch = epoch};
  world_.made[at(id)].committed = 1;
  take(JobState::Cutting);
  return true;
}

bool Rules::write_end(int id, End result, int taken) {
  Attempt& one = world_.now.attempts[at(id)];
  const bool again = flaw_ == Flaw::EndMovesTwice && one.end == End::Done;
  const bool anyway = flaw_ == Flaw::EndUnchecked && one.end != End::Done;
  const bool open = one.open != 0 || one.end == End::Lost || again || anyway;
  if (one.present == 0 || !open) return false;
  const bool ended = daemon::is_terminal(world_.now.job.state);
  const bool stood = stands(id) || ((again || anyway) && !ended);
  const Job before = world_.now.job;
  one.open = one.epoch = 0;
  one.end = stood ? result : End::Superseded;
  for (int k = world_.made[at(id)].first; k < kStrokes; ++k)
    one.fates[at(k)] = k < taken ? kCertain : kNotSent;
  // The database forgot the sheets before: a person looks at this one when it is its turn.
  if (!stood && before.sheet < world_.made[at(id)].sheet) world_.made[at(id)].complete = 0;
  if (!stood) return true;
  if (!at_place(before, world_.made[at(id)])) broken_ = kSuperseded;
  const bool cancel = before.asked == Asked::Cancel;
  if (result != End::Done) {
    interrupt();
    return true;
  }
  if (before.not_good != 0) broken_ = kOverruled;
  next_sheet(false);
  if (cancel && !daemon::is_terminal(world_.now.job.state)) take(JobState::Cancelled);
  return true;
}

void Rules::stroke(int p) {
  Process& one = world_.processes[at(p)];
  Made& made = world_.made[at(one.id)];
  Byte& count = world_.cut[at(made.sheet - 1)][at(made.blank - 1)][one.taken];
  count = static_cast<Byte>(std::min(3, count + 1));
  if (made.committed == 0) broken_ = kUncommitted;
  ++one.taken;
  one.intended = std::max(one.intended, one.taken);
  made.cut_upto = one.taken;
  if (one.taken < kStrokes) return;
  one.doing = Doing::Ended;
  one.result = End::Done;
  made.complete = 1;
}

void Rules::stop(int p) {
  Process& one = world_.processes[at(p)];
  if (one.taken < one.intended) stroke(p);
  if (one.doing == Doing::Ended) return;
  one.doing = Doing::Ended;
  one.result = End::Stopped;
}

void Rules::cut(int p) {
  Process& one = world_.processes[at(p)];
  one.doing = Doing::Cutting;
  one.taken = one.intended = world_.made[one.id].first;
}

void Rules::rest(int p) {
  Process& one = world_.processes[at(p)];
  one.doing = Doing::Idle;
}

// By the clock: no epoch is given twice, whatever a database forgot.
Byte Rules::next_epoch() const {
  Byte most = 0;
  for (const Database* base : {&world_.now, &world_.copy}) {
    for (const Node& node : base->nodes) most = std::max(most, node.epoch);
    for (const Attempt& one : base->attempts) most = std::max(most, one.epoch);
    most = std::max(most, base->job.arm);
  }
  for (const Process& one : world_.processes) most = std::max(most, one.epoch);
  return static_cast<Byte>(std::max(most, world_.stray.epoch) + 1);
}

bool Rules::may_begin(int p) const {
  const Process& one = world_.processes[at(p)];
  const Node& node = world_.now.nodes[at(node_of(p))];
  return one.up != 0 && one.linked != 0 && one.epoch == 0 &&
         (node.lease == Lease::Over || node.folder == folder_of(p) ||
          flaw_ == Flaw::IdentityUnchecked);
}

void Rules::begin(int p) {
  Process& one = world_.processes[at(p)];
  Node& node = world_.now.nodes[at(node_of(p))];
  node.epoch = one.epoch = next_epoch();
  node.lease = Lease::Live;
  node.folder = folder_of(p);
  node.begun = one.fresh = 1;
  one.recovered = 0;
}

void Rules::sweep(int n) {
  Job& job = world_.now.job;
  if (job.state == JobState::Armed && job.arm_node == n + 1) take(JobState::Ready);
  for (int id = 0; id < kAttempts; ++id) {
    if (world_.now.attempts[at(id)].open == 0 || node_of(world_.made[at(id)].process) != n)
      continue;
    lose(id, End::Lost, flaw_ == Flaw::SweepKeepsNotSent ? 0 : kStrokes);
    if (job.state == JobState::Interrupted && flaw_ == Flaw::SweepMakesReady) take(JobState::Ready);
  }
}

void Rules::recover(int p) {
  Process& one = world_.processes[at(p)];
  Node& node = world_.now.nodes[at(node_of(p))];
  Job& job = world_.now.job;
  for (int id = 0; id < world_.next_id; ++id) {
    const bool running = one.doing != Doing::Idle && one.id == id;
    if (world_.now.attempts[at(id)].present == 0) {
      const bool told = flaw_ != Flaw::JournalLoses && !(running && flaw_ == Flaw::ForgetsRunning);
      if (one.journal[at(id)] != 0 && told) bring_back(p, id, running);
      if (!told && running && moves(one)) {
        stop(p);
        rest(p);
      }
    } else if (node_of(world_.made[at(id)].process) == node_of(p)) {
      if (running)
        take_up(p, id);
      else
        close_by_journal(p, id);
    }
  }
  if (job.state == JobState::Armed && job.arm_node == node_of(p) + 1 && job.arm != one.epoch &&
      flaw_ != Flaw::ArmSurvivesRestart)
    take(JobState::Ready);
  one.recovered = 1;
  if (node.owes == folder_of(p)) node.owes = 0;
}

void Rules::revoke_start(int p) {
  Process& one = world_.processes[at(p)];
  Attempt& attempt = world_.now.attempts[one.id];
  if (attempt.present != 0 && (attempt.open != 0 || attempt.end == End::Lost)) {
    const bool stood = stands(one.id);
    const bool cancel = world_.now.job.asked == Asked::Cancel;
    attempt = {.present = 1, .end = End::Refused};
    if (stood) take(cancel ? JobState::Cancelled : JobState::Ready);
  }
  one.journal[one.id] = 0;
  rest(p);
}

// The cut that is under way, or ended and not told.
void Rules::take_up(int p, int id) {
  Process& one = world_.processes[at(p)];
  Attempt& attempt = world_.now.attempts[at(id)];
  if (attempt.open != 0) {
    attempt.epoch = one.epoch;
    if (moves(one) && stands(id)) match_state(p);
    return;
  }
  if (!moves(one)) return;
  const bool stood = stands(id);
  const bool anyway = flaw_ == Flaw::TakesUpSuperseded && attempt.end == End::Lost &&
                      !daemon::is_terminal(world_.now.job.state);
  if (!stood && !anyway) return stop(p);
  if (!stood) broken_ = kSuperseded;
  attempt.open = 1;
  attempt.end = End::None;
  attempt.epoch = one.epoch;
  match_state(p);
}

// Paused if the knife is held, whatever the database last heard; what was asked stays asked.
void Rules::match_state(int p) {
  const bool held =
      world_.processes[at(p)].doing == Doing::Held && flaw_ != Flaw::TakesUpHeldAsCutting;
  const Asked asked = world_.now.job.asked;
  take(held ? JobState::Paused : JobState::Cutting);
  if (!held || asked == Asked::Cancel) world_.now.job.asked = asked;
}

// What may have been sent of an attempt that this process does not do: strokes below it.
int Rules::doubt_upto(int p, int id) const {
  const bool original = world_.made[at(id)].process == p || flaw_ == Flaw::CopyBelieved;
  const Byte journal = world_.processes[at(p)].journal[at(id)];
  return !original || journal == 0 ? kStrokes : journal - 1;
}

// What an earlier life of this node left open, or others called lost meanwhile.
void Rules::close_by_journal(int p, int id) {
  Attempt& attempt = world_.now.attempts[at(id)];
  const bool original = world_.made[at(id)].process == p || flaw_ == Flaw::CopyBelieved;
  if (attempt.open != 0)
    lose(id, original ? End::Crash : End::Lost, doubt_upto(p, id));
  else if (original && stands(id))
    close(id, End::Crash, doubt_upto(p, id));
}

// An attempt that the database does not know, or not any more.
void Rules::bring_back(int p, int id, bool running) {
  Process& one = world_.processes[at(p)];
  const Made& made = world_.made[at(id)];
  // A head without an intent says nothing, in the original as in a copy: not a byte was sent by
  // whoever wrote it, or its START is known.
  const bool sent = one.journal[at(id)] > 1 + made.first;
  const bool cutting = running && (moves(one) || one.doing == Doing::Ended);
  if (!sent && !cutting) return;
  Job& job = world_.now.job;
  // A job that is being cut is left alone: whoever cuts it knows best.
  const auto place = cuts(job) ? daemon::Surfacing::History
                               : daemon::surfacing_of(job.state, {job.sheet, job.blank}, kSheets,
                                                      {made.sheet, made.blank});
  bool first = true;
  for (int other = 0; other < kAttempts; ++other)
    if (world_.now.attempts[at(other)].started != 0 && same_place(made, world_.made[at(other)]))
      first = false;
  world_.now.attempts[at(id)] = {.present = 1, .started = static_cast<Byte>(first ? 1 : 0)};
  // What a copy of a journal knows is no end: the original may still cut.
  const End end = cutting ? End::Superseded : made.process == p ? End::Crash : End::Lost;
  close(id, end, cutting ? kStrokes : doubt_upto(p, id));
  if (place == daemon::Surfacing::Interrupts) {
    go_to(made);
    interrupt();
    if (cutting && first && job.state == JobState::Interrupted) {
      world_.now.attempts[at(id)].end = End::Lost;
      job.not_good = 0;
      reopen(p, id);
      return;
    }
  } else if (place == daemon::Surfacing::InterruptsBefore) {
    job.all_doubt = 1;
    interrupt();
  }
  if (cutting && moves(one)) stop(p);
  // The database forgot what it was of: a person looks at the sheet.
  world_.made[at(id)].complete = 0;
}

void Rules::reopen(int p, int id) {
  Attempt& attempt = world_.now.attempts[at(id)];
  attempt.open = 1;
  attempt.end = End::None;
  attempt.epoch = world_.processes[at(p)].epoch;
  match_state(p);
}

}  // namespace popcut::testing::lease
