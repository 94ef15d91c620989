// SPDX-License-Identifier: MIT
#include "tests/support/lease_world.hpp"

#include <algorithm>
#include <vector>

#include "tests/support/lease_protocol.hpp"

namespace popcut::testing::lease {
namespace {

const char* broken_record(const World& world, int id) {
  const Made& made = world.made[at(id)];
  const Attempt& attempt = world.now.attempts[at(id)];
  const Process& maker = world.processes[made.process];
  const Node& node = world.now.nodes[at(node_of(made.process))];
  const bool doing = maker.doing != Doing::Idle && maker.id == id;
  const bool told = maker.up != 0 && maker.recovered != 0 && maker.epoch == node.epoch &&
                    node.begun != 0 && !doing;
  for (int k = made.first; k < kStrokes; ++k) {
    const bool cut = k < made.cut_upto;
    const Byte fate = attempt.present == 0 ? kNotSent : attempt.fates[at(k)];
    if (cut && fate == kNotSent && attempt.present != 0 && attempt.open == 0) return kFalseNotSent;
    if (cut && fate == kNotSent && told) return kUnrecorded;
    if (!cut && fate == kCertain) return kFalseCertain;
  }
  if (told && attempt.open != 0) return kNobodyCuts;
  if (made.complete != 0 && !doing && world.now.job.state == JobState::Interrupted &&
      at_place(world.now.job, made) && world.now.job.not_good == 0)
    return kLateTruth;
  return nullptr;
}

const char* broken_at(const World& world, int p) {
  const Process& one = world.processes[at(p)];
  const Node& node = world.now.nodes[at(node_of(p))];
  if (!moves(one)) return nullptr;
  const Made& made = world.made[one.id];
  if (made.process != p) return kNotPressed;
  if (made.committed == 0) return kUncommitted;
  for (int q = 0; q < p; ++q) {
    const Process& other = world.processes[at(q)];
    const Made& theirs = world.made[other.id];
    if (moves(other) && theirs.sheet == made.sheet && theirs.blank == made.blank) return kOnePaper;
  }
  const Attempt& attempt = world.now.attempts[one.id];
  const bool holds = one.linked != 0 && one.recovered != 0 && one.epoch == node.epoch &&
                     node.begun != 0 && node.lease == Lease::Live;
  if (holds && (attempt.present == 0 || (attempt.open == 0 && attempt.end == End::Lost)))
    return kOutOfStep;
  const bool held = world.now.job.state == JobState::Paused;
  if (holds && attempt.open != 0 && held != (one.doing == Doing::Held)) return kHeldUnknown;
  return nullptr;
}

bool all_cut(const World& world, int sheet) {
  for (const auto& blank : world.cut[at(sheet)])
    if (std::all_of(blank.begin(), blank.end(), [](Byte count) { return count > 0; })) return true;
  return world.now.said[at(sheet)] != 0 || world.left[at(sheet)] != 0;
}

void number_epochs(World& world) {
  std::array<Byte, 256> names{};
  std::vector<Byte*> all;
  for (Database* base : {&world.now, &world.copy}) {
    for (Node& node : base->nodes) all.push_back(&node.epoch);
    for (Attempt& one : base->attempts) all.push_back(&one.epoch);
    all.push_back(&base->job.arm);
  }
  for (Process& one : world.processes) all.push_back(&one.epoch);
  all.push_back(&world.stray.epoch);
  for (const Byte* one : all) names[*one] = 1;
  Byte next = 0;
  for (std::size_t epoch = 1; epoch < names.size(); ++epoch)
    if (names[epoch] != 0) names[epoch] = ++next;
  names[0] = 0;
  for (Byte* one : all) *one = names[*one];
}

}  // namespace

World first_world() {
  World world{};
  world.now.job = {.state = JobState::Ready, .sheet = 1, .blank = 1, .segment = 1};
  for (int p = 0; p < kNodes; ++p) {
    world.processes[at(p)].up = world.processes[at(p)].linked = 1;
    Rules(world, Flaw::None).begin(p);
    world.processes[at(p)].recovered = 1;
  }
  return world;
}

const char* broken_rule(const World& world) {
  const Job& job = world.now.job;
  for (int sheet = 0; sheet < kSheets; ++sheet)
    for (int blank = 0; blank < kBlanks; ++blank)
      for (int k = 0; k < kStrokes; ++k)
        if (world.cut[at(sheet)][at(blank)][at(k)] > 1 + world.allowed[at(sheet)][at(blank)][at(k)])
          return kCutTwice;
  const bool offered = (job.state == JobState::Ready || job.state == JobState::Armed) &&
                       world.now.nodes[0].owes == 0 && world.now.nodes[1].owes == 0;
  for (int id = 0; id < world.next_id; ++id) {
    const Made& made = world.made[at(id)];
    if (offered && made.cut_upto > made.first && at_place(job, made)) return kOffered;
    if (const char* const broken = broken_record(world, id)) return broken;
  }
  for (int p = 0; p < kProcesses; ++p)
    if (const char* const broken = broken_at(world, p)) return broken;
  // One that the database forgot is refused whatever it asks for, and hears so.
  const auto leads = [](const Process& one) {
    return one.up != 0 && one.epoch != 0 && one.fresh != 0 && one.forgotten == 0;
  };
  if (leads(world.processes[0]) && leads(world.processes[kClone])) return kOneName;
  if (world.cancelled != 0 &&
      (cuts(job) ? job.asked != Asked::Cancel : !daemon::is_terminal(job.state)))
    return kCancelLost;
  if (job.state == JobState::Done)
    for (int sheet = 0; sheet < kSheets; ++sheet)
      if (!all_cut(world, sheet)) return kNotCut;
  return nullptr;
}

bool has_ended(const World& world) { return daemon::is_terminal(world.now.job.state); }

void tidy(World& world) {
  for (Process& one : world.processes) {
    if (one.doing == Doing::Idle) {
      one.id = one.taken = one.intended = 0;
      one.request = Request::UnderWay;
      one.result = End::None;
    }
    if (one.doing != Doing::Starting) one.request = Request::UnderWay;
    if (one.doing != Doing::Ended) one.result = End::None;
  }
  if (has_ended(world)) world.cancelled = 0;
  number_epochs(world);
}

}  // namespace popcut::testing::lease
