// SPDX-License-Identifier: MIT
// Part of tests/support/lease_world.hpp: the steps from one state to the next.
#include <algorithm>
#include <cstring>
#include <utility>
#include <vector>

#include "tests/support/lease_protocol.hpp"

namespace popcut::testing::lease {
namespace {

// What a later attempt leaves of an earlier one's fate: popcut's own rule, stroke by stroke.
Byte merged(Byte before, Byte after) {
  static const auto table = [] {
    std::array<std::array<Byte, 3>, 3> all{};
    for (Byte a = 0; a < 3; ++a)
      for (Byte b = 0; b < 3; ++b) {
        const auto runs = daemon::merged_fates(
            1, {{{{0, 0}, static_cast<PathFate>(a)}}, {{{0, 0}, static_cast<PathFate>(b)}}});
        all.at(a).at(b) = static_cast<Byte>(runs.front().fate);
      }
    return all;
  }();
  return table[before][after];
}

using Fates = std::array<Byte, kStrokes>;

// Whether popcut lets a person resume.
bool may_resume(const Fates& fates, int from, bool twice, bool skip) {
  static const auto table = [] {
    std::vector<bool> all;
    for (int code = 0; code < 3 * 3 * kStrokes * 4; ++code) {
      const Fates now{static_cast<Byte>(code % 3), static_cast<Byte>(code / 3 % 3)};
      std::vector<std::vector<daemon::FateRun>> runs(1);
      for (int k = 0; k < kStrokes; ++k)
        runs[0].push_back({{k, k}, static_cast<PathFate>(now[at(k)])});
      all.push_back(daemon::may_resume(daemon::merged_fates(kStrokes, runs),
                                       {.from_path = code / 9 % kStrokes,
                                        .re_registered = true,
                                        .accept_double_cut = (code / 9 / kStrokes & 1) != 0,
                                        .skip_in_doubt = (code / 9 / kStrokes & 2) != 0},
                                       {.strokes = kStrokes, .same_device_session = false})
                        .has_value());
    }
    return all;
  }();
  return table[at(fates[0] + 3 * fates[1] +
                  9 * (from + kStrokes * ((twice ? 1 : 0) + (skip ? 2 : 0))))];
}

// The next number that no blank of the sheet has.
int next_blank(const World& world) {
  const Job& job = world.now.job;
  int most = job.blank;
  for (int id = 0; id < world.next_id; ++id)
    if (world.now.attempts[at(id)].present != 0 && world.made[at(id)].sheet == job.sheet)
      most = std::max<int>(most, world.made[at(id)].blank);
  return most + 1;
}

Fates fates_of_blank(const World& world) {
  const Job& job = world.now.job;
  Fates fates{};
  for (int id = 0; id < kAttempts; ++id) {
    const Attempt& one = world.now.attempts[at(id)];
    const Made& made = world.made[at(id)];
    if (one.present == 0 || made.sheet != job.sheet || made.blank != job.blank) continue;
    for (int k = 0; k < kStrokes; ++k) fates[at(k)] = merged(fates[at(k)], one.fates[at(k)]);
  }
  if (job.all_doubt != 0)
    for (Byte& fate : fates) fate = std::max(fate, kDoubt);
  return fates;
}

/// The steps from one world.
class Steps {
 public:
  Steps(const World& world, const Bounds& bounds, Flaw flaw,
        const std::function<void(const Step&, World&, const char*)>& found)
      : world_(world),
        may_fail_(world.faults < bounds.faults),
        may_start_(world.next_id < bounds.attempts),
        flaw_(flaw),
        found_(found) {}

  void all() {
    for (int p = 0; p < kProcesses; ++p) {
      of_process(p);
      of_start(p);
      of_cut(p);
      of_end(p);
      persons_at(p);
      if (may_fail_) faults_of(p);
    }
    of_database();
    persons_anywhere();
  }

 private:
  template <typename Change>
  void step(Do what, int process, int detail, const Change& change) {
    World next = world_;
    Rules rules(next, flaw_);
    if (what >= kFirstFault) ++next.faults;
    change(next, rules);
    // The revision of the job stands between it and a request of before.
    if (world_.stray.kind != Stray::None &&
        std::memcmp(&world_.now.job, &next.now.job, sizeof(Job)) != 0)
      next.stray.fresh = 0;
    tidy(next);
    found_({what, static_cast<Byte>(process), static_cast<Byte>(detail)}, next, rules.broken());
  }
  [[nodiscard]] Rules look() const { return {const_cast<World&>(world_), flaw_}; }

  void of_process(int p) {
    const Process& one = world_.processes[at(p)];
    const Node& node = world_.now.nodes[at(node_of(p))];
    if (one.up == 0) {
      if (p != kClone)
        step(Do::Restart, p, 0,
             [p](World& w, Rules&) { w.processes[at(p)].up = w.processes[at(p)].linked = 1; });
      return;
    }
    if (p == kClone) step(Do::CloneStops, p, 0, [p](World& w, Rules&) { forget(w, p, false); });
    if (one.linked == 0) {
      step(Do::Reconnect, p, 0, [p](World& w, Rules&) { w.processes[at(p)].linked = 1; });
      if (one.fresh != 0)
        step(Do::OwnClockEnds, p, 0, [p](World& w, Rules&) { w.processes[at(p)].fresh = 0; });
      return;
    }
    const bool known = one.epoch == node.epoch || flaw_ == Flaw::EpochUnchecked;
    const bool revives = flaw_ == Flaw::HeartbeatRevives && node.lease == Lease::Over;
    if (one.epoch != 0 && known && node.begun != 0 && one.fresh == 0 &&
        (node.lease == Lease::Live || revives))
      step(Do::BeatArrives, p, 0, [p](World& w, Rules&) {
        w.processes[at(p)].fresh = 1;
        w.now.nodes[at(node_of(p))].lease = Lease::Live;
      });
    if (one.epoch != 0 && (!known || node.begun == 0 || (node.lease == Lease::Over && !revives)))
      step(Do::BeatFails, p, 0, [p](World& w, Rules&) {
        Process& self = w.processes[at(p)];
        if (self.doing == Doing::Starting) give_up_start(w, p);
        self.epoch = self.fresh = self.recovered = self.forgotten = 0;
      });
    if (look().may_begin(p)) step(Do::Begins, p, 0, [p](World&, Rules& rules) { rules.begin(p); });
    if (look().calls(p) && one.recovered == 0)
      step(Do::Recovers, p, 0, [p](World&, Rules& rules) { rules.recover(p); });
  }

  /// Its memory is gone, and its knife rests.
  static void forget(World& w, int p, bool keeps_journals) {
    Process& self = w.processes[at(p)];
    if (self.doing == Doing::Ended) w.made[self.id].complete = 0;
    const auto journal = self.journal;
    self = {};
    if (keeps_journals) self.journal = journal;
  }

  /// Its answer counts no more, but it may still be committed.
  static void give_up_start(World& w, int p) {
    Process& self = w.processes[at(p)];
    if (self.request == Request::UnderWay && w.stray.kind == Stray::None)
      w.stray = {.kind = Stray::Start,
                 .process = static_cast<Byte>(p),
                 .epoch = self.epoch,
                 .id = self.id,
                 .fresh = 1};
    self.doing = Doing::Unsure;
  }

  void of_start(int p) {
    const Process& one = world_.processes[at(p)];
    if (one.doing == Doing::Starting && one.request == Request::UnderWay)
      step(Do::StartArrives, p, 0, [p](World& w, Rules& rules) {
        Process& self = w.processes[at(p)];
        self.request =
            rules.commit_start(p, self.epoch, self.id) ? Request::Committed : Request::Refused;
      });
    if (one.doing == Doing::Starting && one.request != Request::UnderWay) answer(p);
    const bool under_way = world_.stray.kind == Stray::Start && world_.stray.id == one.id;
    if (one.doing == Doing::Unsure && one.recovered != 0 && look().calls(p) &&
        (!under_way || flaw_ == Flaw::StartDecidedTooEarly))
      step(Do::Resolves, p, 0, [p](World&, Rules& rules) { rules.revoke_start(p); });
    if (flaw_ == Flaw::TakesBackByGuess && one.up != 0 && one.linked != 0 && one.recovered != 0 &&
        one.epoch == world_.now.nodes[at(node_of(p))].epoch && one.doing == Doing::Idle)
      guess(p);
    if (!may_fail_ || one.doing != Doing::Starting) return;
    step(Do::StartLost, p, 0, [p, this](World& w, Rules& rules) {
      w.processes[at(p)].doing = Doing::Unsure;
      w.processes[at(p)].linked = 0;
      if (flaw_ == Flaw::StartsOnLostAnswer) rules.cut(p);
    });
    if (one.request != Request::UnderWay || world_.stray.kind != Stray::None) return;
    step(Do::StartDelayed, p, 0, [p](World& w, Rules&) {
      give_up_start(w, p);
      w.processes[at(p)].linked = 0;
    });
    step(Do::StartRepeated, p, 0, [p](World& w, Rules& rules) {
      Process& self = w.processes[at(p)];
      w.stray = {.kind = Stray::Start,
                 .process = static_cast<Byte>(p),
                 .epoch = self.epoch,
                 .id = self.id};
      self.request =
          rules.commit_start(p, self.epoch, self.id) ? Request::Committed : Request::Refused;
    });
  }
  void answer(int p) {
    const Process& one = world_.processes[at(p)];
    const bool begins =
        one.request == Request::Committed && (one.fresh != 0 || flaw_ == Flaw::StartsOnLateAnswer);
    const bool valid = world_.now.attempts[one.id].open != 0;
    const char* const broken = begins && !valid ? kStartOver : nullptr;
    World next = world_;
    Rules rules(next, flaw_);
    Process& self = next.processes[at(p)];
    if (begins) {
      rules.cut(p);
    } else if (one.request == Request::Committed) {
      self.doing = Doing::Unsure;
    } else {
      self.journal[one.id] = 0;
      rules.rest(p);
    }
    tidy(next);
    found_({Do::AnswerArrives, static_cast<Byte>(p), static_cast<Byte>(begins ? 1 : 0)}, next,
           broken);
  }

  void guess(int p) {
    for (int id = 0; id < kAttempts; ++id)
      if (world_.now.attempts[at(id)].open != 0 && world_.made[at(id)].process == p)
        step(Do::Guesses, p, 0, [p, id](World& w, Rules& rules) {
          w.processes[at(p)].id = static_cast<Byte>(id);
          rules.revoke_start(p);
        });
  }

  void of_cut(int p) {
    const Process& one = world_.processes[at(p)];
    if (!moves(one)) return;
    const Job& job = world_.now.job;
    const Attempt& attempt = world_.now.attempts[one.id];
    const bool told = look().calls(p) && one.recovered != 0 && attempt.present != 0;
    const bool at_end = one.taken == one.intended;  // of a stroke
    if (told && attempt.open == 0 && attempt.end != End::Lost)
      step(Do::Notices, p, 0, [p](World&, Rules& rules) { rules.stop(p); });
    if (told && attempt.open != 0 && job.asked == Asked::Cancel && at_end)
      step(Do::Stops, p, 0, [p](World&, Rules& rules) { rules.stop(p); });
    if (one.doing == Doing::Held) return;
    if (told && attempt.open != 0 && job.asked == Asked::Pause && at_end)
      step(Do::Holds, p, 0, [p](World& w, Rules& rules) {
        w.processes[at(p)].doing = Doing::Held;
        rules.take(JobState::Paused);
      });
    if (!at_end || flaw_ == Flaw::SendsBeforeCommit)
      step(Do::Strokes, p, one.taken, [p](World&, Rules& rules) { rules.stroke(p); });
    if (at_end) intends(p, told && attempt.open != 0);
  }
  void intends(int p, bool told) {
    const auto intend = [p](World& w) {
      Process& self = w.processes[at(p)];
      self.journal[self.id] = static_cast<Byte>(1 + ++self.intended);
    };
    step(Do::Intends, p, told ? 1 : 0, [&](World& w, Rules& rules) {
      intend(w);
      const Process& self = w.processes[at(p)];
      if (told) rules.mark(self.id, self.taken, self.intended);
    });
    if (!told || !may_fail_ || world_.stray.kind != Stray::None) return;
    for (const Do what : {Do::MarkDelayed, Do::MarkRepeated})
      step(what, p, 0, [&](World& w, Rules& rules) {
        intend(w);
        Process& self = w.processes[at(p)];
        w.stray = {.kind = Stray::Mark,
                   .process = static_cast<Byte>(p),
                   .epoch = self.epoch,
                   .id = self.id,
                   .taken = self.taken,
                   .intended = self.intended};
        if (what == Do::MarkRepeated)
          rules.mark(self.id, self.taken, self.intended);
        else
          self.linked = 0;
      });
  }

  void of_end(int p) {
    const Process& one = world_.processes[at(p)];
    if (one.doing != Doing::Ended || one.recovered == 0 || !look().calls(p)) return;
    const auto tell = [this, p](World& w, Rules& rules) {
      Process& self = w.processes[at(p)];
      rules.write_end(self.id, self.result, self.taken);
      if (flaw_ == Flaw::JournalForgotten) self.journal[self.id] = 0;
      rules.rest(p);
    };
    step(Do::Tells, p, 0, tell);
    if (!may_fail_) return;
    step(Do::EndUnanswered, p, 0, [p](World& w, Rules& rules) {
      Process& self = w.processes[at(p)];
      rules.write_end(self.id, self.result, self.taken);
      self.linked = 0;
    });
    if (world_.stray.kind != Stray::None) return;
    const Message message{.kind = Stray::End,
                          .process = static_cast<Byte>(p),
                          .epoch = one.epoch,
                          .id = one.id,
                          .taken = one.taken,
                          .result = one.result};
    step(Do::EndDelayed, p, 0, [&](World& w, Rules&) {
      w.stray = message;
      w.processes[at(p)].linked = 0;
    });
    step(Do::EndRepeated, p, 0, [&](World& w, Rules& rules) {
      w.stray = message;
      tell(w, rules);
    });
  }

  void of_database() {
    for (int n = 0; n < kNodes; ++n) {
      const Node& node = world_.now.nodes[at(n)];
      bool held = false, anyone = false, left = world_.now.job.arm_node == n + 1;
      for (int p = 0; p < kProcesses; ++p) {
        const Process& one = world_.processes[at(p)];
        held =
            held || (node_of(p) == n && one.up != 0 && one.epoch == node.epoch && one.fresh != 0);
        anyone = anyone || look().works(p);
      }
      for (int id = 0; id < kAttempts; ++id)
        left = left ||
               (world_.now.attempts[at(id)].open != 0 && node_of(world_.made[at(id)].process) == n);
      if (node.lease == Lease::Live && !held)
        step(Do::LeaseEnds, n, 0,
             [n](World& w, Rules&) { w.now.nodes[at(n)].lease = Lease::Over; });
      if (left && anyone && (node.lease == Lease::Over || flaw_ == Flaw::SweepsTheLiving))
        step(Do::Sweeps, n, 0, [n](World&, Rules& rules) { rules.sweep(n); });
    }
    if (world_.stray.kind != Stray::None) {
      step(Do::StrayLost, world_.stray.process, 0, [](World& w, Rules&) { w.stray = {}; });
      step(Do::StrayArrives, world_.stray.process, static_cast<int>(world_.stray.kind), arrive);
    }
    const bool cloned_since = world_.now.nodes[0].folder == folder_of(kClone) &&
                              world_.copy.nodes[0].folder != folder_of(kClone);
    if (world_.has_copy != 0 && !cloned_since)
      step(Do::GoesBack, 0, 0, [this](World& w, Rules&) { go_back(w); });
    if (may_fail_ && world_.has_copy == 0)
      step(Do::CopyMade, 0, 0, [](World& w, Rules&) {
        w.copy = w.now;
        w.has_copy = 1;
      });
  }
  static void arrive(World& w, Rules& rules) {
    const Message message = std::exchange(w.stray, Message{});
    const Attempt& attempt = w.now.attempts[message.id];
    const bool newest = rules.newest(message.process, message.epoch);
    switch (message.kind) {
      case Stray::Start:
        if (message.fresh != 0) rules.commit_start(message.process, message.epoch, message.id);
        break;
      case Stray::Mark:
        if (attempt.present != 0 &&
            ((newest && attempt.open != 0 && attempt.epoch == message.epoch) ||
             rules.unchecked_marks()))
          rules.mark(message.id, message.taken, message.intended);
        break;
      case Stray::End:
        if (newest) rules.write_end(message.id, message.result, message.taken);
        break;
      case Stray::None:
        break;
    }
  }
  void go_back(World& w) const {
    w.now = w.copy;
    w.copy = {};
    w.has_copy = w.cancelled = 0;
    w.stray = {};
    for (int n = 0; n < kNodes; ++n) {
      Node& node = w.now.nodes[at(n)];
      node.owes = node.folder == 0 ? folder_of(n) : node.folder;
      node.begun = 0;
      if (flaw_ == Flaw::GoesOnAfterRestore) node.begun = 1;
      if (flaw_ == Flaw::GoesOnAfterRestore || flaw_ == Flaw::ArmsBeforeAllReported) node.owes = 0;
    }
    for (int p = 0; p < kProcesses; ++p) {
      Process& one = w.processes[at(p)];
      if (one.doing == Doing::Starting) one.doing = Doing::Unsure;
      if (one.epoch != 0 && one.epoch != w.now.nodes[at(node_of(p))].epoch) one.forgotten = 1;
    }
    for (int id = 0; id < kAttempts; ++id) {
      const Process& one = w.processes[w.made[at(id)].process];
      if (one.doing != Doing::Ended || one.id != id) w.made[at(id)].complete = 0;
    }
  }

  void persons_at(int p) {
    const Process& one = world_.processes[at(p)];
    const Job& job = world_.now.job;
    if (one.doing == Doing::Held && job.state == JobState::Paused && job.asked == Asked::Nothing &&
        look().calls(p) && world_.now.attempts[one.id].open != 0)
      step(Do::Resumes, p, 0, [p](World& w, Rules& rules) {
        w.processes[at(p)].doing = Doing::Cutting;
        rules.take(JobState::Cutting);
      });
    if (one.doing != Doing::Idle || !look().works(p)) return;
    if (job.state == JobState::Ready && look().reported() && may_start_)
      step(Do::Arms, p, 0, [p](World& w, Rules& rules) {
        rules.take(JobState::Armed);
        w.now.job.arm = w.processes[at(p)].epoch;
        w.now.job.arm_node = static_cast<Byte>(node_of(p) + 1);
      });
    const bool armed = job.arm_node == node_of(p) + 1 &&
                       (job.arm == one.epoch || flaw_ == Flaw::ArmSurvivesRestart ||
                        flaw_ == Flaw::EpochUnchecked);
    if (job.state == JobState::Armed && armed && may_start_)
      step(Do::PressesStart, p, 0, [this, p](World& w, Rules& rules) { press_start(w, rules, p); });
    if (job.state == JobState::Interrupted) resume_from(p);
  }
  void press_start(World& w, Rules& rules, int p) const {
    Process& self = w.processes[at(p)];
    const Job& job = w.now.job;
    self.id = w.next_id++;
    w.made[self.id] = {.process = static_cast<Byte>(p),
                       .sheet = job.sheet,
                       .blank = job.blank,
                       .segment = job.segment,
                       .first = job.first,
                       .cut_upto = job.first};
    self.journal[self.id] = static_cast<Byte>(1 + job.first);
    self.doing = Doing::Starting;
    self.request = Request::UnderWay;
    if (flaw_ == Flaw::SendsBeforeCommit) rules.cut(p);
  }
  void resume_from(int p) {
    const Job& job = world_.now.job;
    int last = -1;
    for (int id = 0; id < world_.next_id; ++id) {
      const Made& made = world_.made[at(id)];
      if (world_.now.attempts[at(id)].present != 0 && made.sheet == job.sheet &&
          made.blank == job.blank)
        last = id;
    }
    if (last < 0 || node_of(world_.made[at(last)].process) != node_of(p) ||
        world_.made[at(last)].segment >= kSegments)
      return;
    // Nobody takes a sheet out of a cutter that cuts it.
    for (const Process& other : world_.processes)
      if (moves(other) && world_.made[other.id].sheet == job.sheet &&
          world_.made[other.id].blank == job.blank)
        return;
    const Fates fates = fates_of_blank(world_);
    for (int code = 0; code < kStrokes * 4; ++code) {
      const int from = code % kStrokes;
      const bool twice = (code / kStrokes & 1) != 0;
      const bool skip = (code / kStrokes & 2) != 0;
      // With no more allowed than it needs.
      if (!may_resume(fates, from, twice, skip) ||
          (twice && may_resume(fates, from, false, skip)) ||
          (skip && may_resume(fates, from, twice, false)))
        continue;
      step(Do::ResumesFrom, p, code, [&](World& w, Rules& rules) {
        Job& now = w.now.job;
        now.segment = static_cast<Byte>(w.made[at(last)].segment + 1);
        now.first = static_cast<Byte>(from);
        now.not_good = 0;
        if (skip) w.left[at(now.sheet - 1)] = 1;
        rules.take(JobState::Ready);
        for (int k = from; twice && k < kStrokes; ++k) {
          Byte& count = w.allowed[at(now.sheet - 1)][at(now.blank - 1)][at(k)];
          count = static_cast<Byte>(std::min(3, count + 1));
        }
      });
    }
  }

  void persons_anywhere() {
    bool anyone = false;
    for (int p = 0; p < kProcesses; ++p)
      anyone = anyone || (world_.processes[at(p)].up != 0 && world_.processes[at(p)].linked != 0);
    const Job& job = world_.now.job;
    if (!anyone || daemon::is_terminal(job.state)) return;
    const bool interrupted = job.state == JobState::Interrupted;
    if (job.state == JobState::Armed)
      step(Do::Disarms, 0, 0, [](World&, Rules& rules) { rules.take(JobState::Ready); });
    if (interrupted || job.state == JobState::Ready)
      step(Do::Skips, 0, 0, [](World&, Rules& rules) { rules.next_sheet(true); });
    if (job.state == JobState::Cutting && job.asked == Asked::Nothing)
      step(Do::Pauses, 0, 0, [](World& w, Rules&) { w.now.job.asked = Asked::Pause; });
    if (job.asked != Asked::Cancel)
      step(Do::Cancels, 0, 0, [&](World& w, Rules& rules) {
        if (!cuts(w.now.job)) return rules.take(JobState::Cancelled);
        w.now.job.asked = Asked::Cancel;
        w.cancelled = 1;
      });
    if (!interrupted) return;
    const Fates fates = fates_of_blank(world_);
    if (std::find(fates.begin(), fates.end(), kNotSent) == fates.end())
      step(Do::Confirms, 0, 0, [](World&, Rules& rules) { rules.next_sheet(true); });
    if (job.not_good == 0)
      step(Do::SaysNotGood, 0, 0, [](World& w, Rules&) { w.now.job.not_good = 1; });
    if (next_blank(world_) <= kBlanks)
      step(Do::TakesNewBlank, 0, 0, [](World& w, Rules& rules) {
        Job& now = w.now.job;
        now.blank = static_cast<Byte>(next_blank(w));
        now.segment = 1;
        now.first = now.not_good = now.all_doubt = 0;
        rules.take(JobState::Ready);
      });
  }

  void faults_of(int p) {
    const Process& one = world_.processes[at(p)];
    if (one.up != 0 && p != kClone)
      step(Do::Dies, p, 0, [p](World& w, Rules&) { forget(w, p, true); });
    if (one.up != 0 && one.linked != 0 && one.doing != Doing::Starting)
      step(Do::LinkBreaks, p, 0, [p](World& w, Rules&) { w.processes[at(p)].linked = 0; });
    if (one.up != 0 && one.linked != 0 && one.fresh != 0)
      step(Do::BeatsSlow, p, 0, [p](World& w, Rules&) { w.processes[at(p)].fresh = 0; });
    if (p == kClone && world_.cloned == 0 && world_.now.nodes[0].folder != 0)
      step(Do::Cloned, p, 0, [](World& w, Rules&) {
        Process& clone = w.processes[kClone];
        clone.up = clone.linked = w.cloned = 1;
        clone.journal = w.processes[0].journal;
      });
  }

  const World& world_;
  const bool may_fail_, may_start_;
  const Flaw flaw_;
  const std::function<void(const Step&, World&, const char*)>& found_;
};

}  // namespace

void each_step(const World& world, const Bounds& bounds, Flaw flaw,
               const std::function<void(const Step&, World&, const char*)>& found) {
  Steps(world, bounds, flaw, found).all();
}

}  // namespace popcut::testing::lease
