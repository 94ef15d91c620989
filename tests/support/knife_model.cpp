// SPDX-License-Identifier: MIT
#include "tests/support/knife_model.hpp"

#include <algorithm>
#include <array>
#include <functional>
#include <unordered_set>

#include <fmt/format.h>

#include "daemon/jobs/intents.hpp"
#include "daemon/jobs/resume.hpp"
#include "daemon/jobs/rules.hpp"

namespace popcut::testing {
namespace {

using namespace popcut::daemon;

constexpr int kStrokes = 2;
constexpr int kBlanks = 2;
constexpr std::size_t kAttempts = 3;

/// A row of the table of attempts.
struct Attempt {
  std::int8_t id{}, blank{1}, segment{1}, first{0};
  std::int8_t open{1}, recorded{-1};
  std::array<std::int8_t, kStrokes> fates{};  ///< PathFate
};

/// What the database holds.
struct Base {
  JobState state{JobState::Ready};
  std::int8_t blank{1}, segment{1}, first{0}, pausing{0}, cancelling{0}, said{0};
  std::vector<Attempt> attempts{};
};

/// The files of one attempt. What they are of is in their heads, so both know it.
struct Trail {
  std::int8_t id{}, blank{1}, segment{1}, first{0};
  std::int8_t list{1}, records{0};  ///< the list: whether it is there, and its records
  std::int8_t counted{0};           ///< the witness
  std::array<std::int8_t, kStrokes + 1> lasts{};  ///< what each record says, from 1
  std::int8_t ended{0};                           ///< its end is committed
};

struct World {
  // On the disk. `kept` is what is left of the database when its log loses its end.
  Base now, kept;
  bool in_step{true};  ///< nothing is behind yet
  std::vector<Trail> trails;
  // In popcutd's memory; the newest attempt is the running one.
  bool cutting{false};
  std::int8_t intended{-1}, taken{-1};
  std::int8_t next_id{1};
  bool armed{false};
  // What is so, whoever knows it.
  std::array<std::array<std::int8_t, kStrokes>, kBlanks + 1> cut{}, allowed{};
};

void put(std::string& key, std::int8_t value) { key += static_cast<char>(value); }

void put(std::string& key, const Base& base) {
  put(key, static_cast<std::int8_t>(base.state));
  for (const std::int8_t value :
       {base.blank, base.segment, base.first, base.pausing, base.cancelling, base.said})
    put(key, value);
  put(key, static_cast<std::int8_t>(base.attempts.size()));
  for (const Attempt& one : base.attempts) {
    for (const std::int8_t value :
         {one.id, one.blank, one.segment, one.first, one.open, one.recorded})
      put(key, value);
    for (const std::int8_t fate : one.fates) put(key, fate);
  }
}

std::string key_of(const World& world) {
  std::string key;
  key.reserve(96);
  put(key, world.now);
  put(key, world.in_step);
  if (!world.in_step) put(key, world.kept);
  put(key, static_cast<std::int8_t>(world.trails.size()));
  for (const Trail& one : world.trails) {
    for (const std::int8_t value :
         {one.id, one.blank, one.segment, one.first, one.list, one.records, one.counted, one.ended})
      put(key, value);
    for (const std::int8_t last : one.lasts) put(key, last);
  }
  for (const std::int8_t value : {world.intended, world.taken, world.next_id}) put(key, value);
  put(key, world.cutting);
  put(key, world.armed);
  for (const auto& counts : {world.cut, world.allowed})
    for (const auto& blank : counts)
      for (const std::int8_t count : blank) put(key, count);
  return key;
}

std::vector<FateRun> runs_of(const Base& base, int blank) {
  std::vector<std::vector<FateRun>> all;
  for (const Attempt& one : base.attempts) {
    if (one.blank != blank) continue;
    std::vector<FateRun> runs;
    for (std::int64_t k = 0; k < kStrokes; ++k)
      if (const auto fate = static_cast<PathFate>(one.fates.at(static_cast<std::size_t>(k)));
          fate != PathFate::NotSent)
        runs.push_back({{k, k}, fate});
    all.push_back(std::move(runs));
  }
  return merged_fates(kStrokes, all);
}

JobFacts facts_of(const Base& base) {
  return {.state = base.state,
          .pausing = base.pausing != 0,
          .cancelling = base.cancelling != 0,
          .begun = base.segment > 1};
}

void set_fates(Attempt& attempt, int from, int upto, PathFate fate) {
  for (int k = std::max<int>(from, attempt.first); k <= std::min(upto, kStrokes - 1); ++k)
    attempt.fates.at(static_cast<std::size_t>(k)) = static_cast<std::int8_t>(fate);
}

class Explorer {
 public:
  Explorer(int depth, Flaw flaw) : depth_(depth), flaw_(flaw) {}

  Exploration run() {
    add({}, "a job is ready", 0);
    std::size_t level_end = 1;
    for (std::size_t at = 0; at < nodes_.size() && result_.wrong.empty(); ++at) {
      if (at == level_end) {
        ++result_.depth;
        level_end = nodes_.size();
      }
      if (result_.depth == depth_) break;
      from_ = at;
      const World world = nodes_[at].world;
      persons_acts(world);
      cutters_acts(world);
      crashes(world);
      // What follows from it is all found: only how it was reached is still wanted.
      nodes_[at].world = {};
    }
    result_.states = nodes_.size();
    return result_;
  }

 private:
  struct Node {
    World world;
    std::string what;
    std::size_t from;
  };

  void add(World world, const std::string& what, std::size_t from) {
    ++result_.steps;
    if (!result_.wrong.empty()) return;
    const std::string wrong = wrong_in(world);
    if (!seen_.insert(key_of(world)).second) return;
    nodes_.push_back({std::move(world), what, from});
    if (wrong.empty()) return;
    result_.wrong = wrong;
    for (std::size_t node = nodes_.size() - 1;; node = nodes_[node].from) {
      result_.path.insert(result_.path.begin(), nodes_[node].what);
      if (node == 0) break;
    }
  }
  void next(const World& world, const std::string& what) { add(world, what, from_); }

  /// The database as it now is, and what the end of its log may lose.
  void commit(World world, const Base& base, const std::string& what) {
    if (world.in_step) {
      World behind = world;
      behind.kept = behind.now;
      behind.in_step = false;
      behind.now = base;
      next(behind, what);
    }
    world.now = base;
    next(world, what);
  }

  static bool cut_or_said(const World& world) {
    const auto& cut = world.cut.at(static_cast<std::size_t>(world.now.blank));
    return world.now.said != 0 ||
           std::all_of(cut.begin(), cut.end(), [](std::int8_t count) { return count > 0; });
  }

  static std::string wrong_in(const World& world) {
    for (std::size_t blank = 1; blank <= kBlanks; ++blank)
      for (std::size_t k = 0; k < kStrokes; ++k)
        if (world.cut[blank][k] > 1 + world.allowed[blank][k])
          return fmt::format("stroke {} of blank {} is cut twice, and nobody said so", k, blank);
    const Base& base = world.now;
    if (base.state == JobState::Done && !cut_or_said(world)) return "done, but not cut";
    if (!is_terminal(base.state) && allowed_actions(facts_of(base)).empty())
      return "there is nothing that can be done with the job";
    if (world.cutting || base.state != JobState::Interrupted) return {};
    const auto& cut = world.cut.at(static_cast<std::size_t>(base.blank));
    for (const FateRun& run : runs_of(base, base.blank))
      for (std::int64_t k = run.paths.first; k <= run.paths.last; ++k) {
        const bool was_cut = cut.at(static_cast<std::size_t>(k)) > 0;
        if (run.fate == PathFate::Certain && !was_cut)
          return fmt::format("stroke {} is certain, but not cut", k);
        if (run.fate == PathFate::NotSent && was_cut)
          return fmt::format("stroke {} is not sent, but cut", k);
      }
    return {};
  }

  void take(Base& base, Step step) {
    base.state = state_after(base.state, step, 1, 1);
    base.pausing = base.cancelling = 0;
  }

  void persons_acts(const World& world) {
    for (const JobAction action : all_actions()) {
      const Step step = step_of(facts_of(world.now), action);
      if (step == Step::Refused) continue;
      Base base = world.now;
      World after = world;
      switch (action) {
        case JobAction::Start:
          break;
        case JobAction::Pause:
          base.pausing = 1;
          commit(after, base, "a person pauses");
          break;
        case JobAction::Resume:
          if (!world.cutting) break;
          if (base.state == JobState::Paused) take(base, step);
          base.pausing = 0;
          commit(after, base, "a person resumes");
          break;
        case JobAction::Cancel:
          if (step == Step::Stays)
            base.cancelling = 1;
          else
            take(base, step);
          commit(after, base, "a person cancels");
          break;
        case JobAction::Disarm:
          break;  // armed is what a step goes through
        case JobAction::Arm:
          take(base, step);
          after.now = base;
          recover(after, "a person arms, popcutd dies");
          if (step_of(facts_of(base), JobAction::Start) != Step::Refused) start(after);
          break;
        case JobAction::ConfirmResult: {
          bool not_sent = false;
          for (const FateRun& run : runs_of(base, base.blank))
            not_sent = not_sent || run.fate == PathFate::NotSent;
          if (not_sent) break;
          base.said = 1;
          take(base, step);
          commit(after, base, "a person says that it is good");
          break;
        }
        case JobAction::RetrySheet:
          if (base.blank == kBlanks) break;
          ++base.blank;
          base.segment = 1;
          base.first = base.said = 0;
          take(base, step == Step::Stays ? Step::ToReady : step);
          commit(after, base, "a person takes a new blank");
          break;
        case JobAction::SkipSheet:
          base.said = 1;
          take(base, step);
          commit(after, base, "a person skips it");
          break;
        case JobAction::ResumeFrom:
          resume_from(world);
          break;
      }
    }
  }

  void resume_from(const World& world) {
    const Attempt* last = nullptr;
    for (const Attempt& one : world.now.attempts)
      if (one.blank == world.now.blank) last = &one;
    if (last == nullptr) return;
    for (int from = 0; from < kStrokes; ++from)
      for (const unsigned words : {0U, 1U, 2U}) {
        const bool twice = (words & 1U) != 0;
        const bool skip = (words & 2U) != 0;
        const bool may = may_resume(runs_of(world.now, world.now.blank),
                                    {.from_path = from,
                                     .re_registered = true,
                                     .accept_double_cut = twice || flaw_ == Flaw::ResumesOverDoubt,
                                     .skip_in_doubt = skip},
                                    {.strokes = kStrokes, .same_device_session = false})
                             .has_value();
        if (!may) continue;
        World after = world;
        Base base = world.now;
        base.segment = static_cast<std::int8_t>(last->segment + 1);
        base.first = static_cast<std::int8_t>(from);
        base.state = JobState::Ready;
        if (skip) base.said = 1;  // that these may stay uncut
        if (twice)
          for (int k = from; k < kStrokes; ++k) {
            auto& allowed = after.allowed.at(static_cast<std::size_t>(base.blank))
                                .at(static_cast<std::size_t>(k));
            allowed = static_cast<std::int8_t>(std::min(3, allowed + 1));
          }
        commit(after, base,
               fmt::format("a person resumes from {}{}{}", from, twice ? ", twice" : "",
                           skip ? ", skipping doubt" : ""));
      }
  }

  void start(const World& world) {
    if (world.now.attempts.size() >= kAttempts || world.trails.size() >= kAttempts) return;
    for (const Attempt& one : world.now.attempts)
      if (one.blank == world.now.blank && one.segment == world.now.segment) return;
    World after = world;
    Base base = world.now;
    const Trail trail{.id = after.next_id,
                      .blank = base.blank,
                      .segment = base.segment,
                      .first = base.first,
                      .lasts = {static_cast<std::int8_t>(base.first - 1)}};
    ++after.next_id;
    after.trails.push_back(trail);
    recover(after, "popcutd dies while it starts the cut");
    base.attempts.push_back(
        {.id = trail.id, .blank = base.blank, .segment = base.segment, .first = base.first});
    take(base, Step::ToCutting);
    after.cutting = true;
    after.intended = after.taken = static_cast<std::int8_t>(base.first - 1);
    commit(after, base, "a person arms and starts");
  }

  static World with_a_stroke(World world) {
    ++world.taken;
    auto& cut = world.cut.at(static_cast<std::size_t>(world.now.blank))
                    .at(static_cast<std::size_t>(world.taken));
    cut = static_cast<std::int8_t>(std::min(4, cut + 1));
    return world;
  }

  void cutters_acts(const World& world) {
    if (!world.cutting) return;
    World after = world;
    Trail& trail = after.trails.back();
    Base base = world.now;
    Attempt& attempt = base.attempts.back();
    const bool holds = base.pausing != 0 || base.cancelling != 0;
    // The next intent, record by record: popcutd may die between any two.
    const auto wanted = static_cast<std::int8_t>(world.intended + 1);
    if (wanted < kStrokes && !holds && world.taken >= world.intended) {
      ++trail.records;
      trail.lasts.at(static_cast<std::size_t>(trail.records)) = wanted;
      recover(after, fmt::format("popcutd dies with the intent of {} in the journal", wanted));
      trail.counted = trail.records;
      recover(after, fmt::format("popcutd dies with the intent of {} counted", wanted));
      after.intended = attempt.recorded = wanted;
      set_fates(attempt, attempt.first, wanted, PathFate::InDoubt);
      set_fates(attempt, attempt.first, world.taken - 1, PathFate::Certain);
      for (const bool behind : {false, true}) {
        World recorded = after;
        if (behind && !recorded.in_step) continue;
        if (behind) {
          recorded.kept = recorded.now;
          recorded.in_step = false;
        }
        recorded.now = base;
        recover(recorded, fmt::format("popcutd dies with the intent of {} recorded", wanted));
        next(with_a_stroke(recorded), fmt::format("stroke {} is intended and taken", wanted));
      }
    }
    if (flaw_ == Flaw::SendsBeforeIntent && world.taken == world.intended && wanted < kStrokes)
      next(with_a_stroke(world), fmt::format("the cutter takes stroke {} early", wanted));
    if (base.pausing != 0 && base.state == JobState::Cutting) {
      Base held = world.now;
      take(held, step_of(held.state, JobEvent::CutHeld));
      commit(world, held, "the cutter holds");
    }
    end(world);
  }

  void end(const World& world) {
    const auto over = [&](JobEvent event, int certain, const char* what) {
      World after = world;
      Base base = world.now;
      Attempt& attempt = base.attempts.back();
      attempt.fates = {};
      set_fates(attempt, attempt.first, world.taken, PathFate::InDoubt);
      set_fates(attempt, attempt.first, certain, PathFate::Certain);
      attempt.open = 0;
      take(base, step_of(base.state, event));
      after.cutting = false;
      after.intended = after.taken = -1;
      after.trails.back().ended = 1;
      if (flaw_ == Flaw::ForgetsAtTheEnd) after.trails.pop_back();
      commit(after, base, what);
    };
    if (world.taken == kStrokes - 1)
      over(JobEvent::CutCompletes, world.taken, "the cutter is through");
    else if (world.now.cancelling != 0)
      over(JobEvent::CutStops, world.taken, "the cutter stops");
    else
      over(JobEvent::CutBreaks, world.taken - 1, "the cable is pulled");
  }

  // Everything that may be left of the records.
  void crashes(const World& world) {
    if (!world.cutting) {
      World after = world;
      after.kept = {};
      after.in_step = true;
      std::erase_if(after.trails, [](const Trail& one) { return one.ended != 0; });
      next(after, "the log is moved into the database");
    }
    recover(world, "popcutd dies");
  }

  enum class Witness : std::uint8_t { Whole, Torn, Old, Gone };

  void recover(const World& world, const std::string& what) {
    for (const bool log_lost : {false, true}) {
      if (log_lost && world.in_step) continue;
      World left = world;
      if (log_lost) left.now = world.kept;
      left.in_step = true;
      left.kept = {};
      const std::string told = what + (log_lost ? ", the log loses its end" : "");
      if (world.trails.empty()) {
        restart(left, {}, told);
        continue;
      }
      // Of the newest attempt any record may have lost something.
      const Trail& whole = world.trails.back();
      const bool known = std::any_of(left.now.attempts.begin(), left.now.attempts.end(),
                                     [&](const Attempt& one) { return one.id == whole.id; });
      for (int records = -1; records <= whole.records; ++records)
        for (const Witness witness : {Witness::Whole, Witness::Torn, Witness::Old, Witness::Gone}) {
          const bool list_hurt = records < whole.records;
          if (witness == Witness::Gone && records < 0 && !known) continue;
          if (witness == Witness::Old && (list_hurt || whole.counted == 0)) continue;
          World damaged = left;
          damaged.trails.back().list = records < 0 ? 0 : 1;
          damaged.trails.back().records = static_cast<std::int8_t>(std::max(0, records));
          restart(damaged, witness,
                  told +
                      (records < 0 ? ", the journal is gone"
                       : list_hurt ? ", the journal loses its end"
                                   : "") +
                      (witness == Witness::Torn   ? ", the witness is torn"
                       : witness == Witness::Old  ? ", the witness is an old one"
                       : witness == Witness::Gone ? ", the witness is gone"
                                                  : ""));
        }
    }
  }

  [[nodiscard]] IntentClaims claims_of(const Trail& trail, Witness witness, bool newest,
                                       std::int64_t recorded) const {
    const auto last_of = [&](int record) -> std::int64_t {
      return trail.lasts.at(static_cast<std::size_t>(record));
    };
    IntentClaims claims{.first = trail.first, .strokes = kStrokes, .recorded = recorded};
    if (trail.list != 0) claims.journal = {true, trail.records, last_of(trail.records)};
    int counted = trail.counted;
    bool torn = false;
    if (newest && witness == Witness::Old) --counted;
    if (newest && witness == Witness::Torn) {
      // The slot that is written next, if one was being written; else the newer one.
      torn = true;
      if (!(trail.records > counted)) counted = std::max(0, counted - 1);
    }
    if (!(newest && witness == Witness::Gone))
      claims.witness = {.there = true,
                        .whole = !torn,
                        .records = counted,
                        .last = last_of(counted),
                        .last_before = torn ? -1 : last_of(std::max(0, counted - 1))};
    if (flaw_ == Flaw::IgnoresWitness)
      claims.witness = {.there = true,
                        .whole = true,
                        .records = claims.journal.records,
                        .last = std::max(claims.journal.last, recorded),
                        .last_before = -1};
    return claims;
  }

  void restart(World world, Witness witness, const std::string& what) {
    ++result_.recoveries;
    world.cutting = world.armed = false;
    world.intended = world.taken = -1;
    Base& base = world.now;
    for (Attempt& one : base.attempts) {
      if (one.open == 0) continue;
      const auto trail = std::find_if(world.trails.begin(), world.trails.end(),
                                      [&](const Trail& files) { return files.id == one.id; });
      IntentClaims claims{.first = one.first, .strokes = kStrokes, .recorded = one.recorded};
      if (trail != world.trails.end())
        claims = claims_of(*trail, witness, &*trail == &world.trails.back(), one.recorded);
      std::int64_t doubt_upto = verdict_on(claims).doubt_upto;
      if (flaw_ == Flaw::DatabaseOnly) doubt_upto = one.recorded;
      const std::array<std::int8_t, kStrokes> fates = one.fates;
      set_fates(one, one.first, static_cast<int>(doubt_upto), PathFate::InDoubt);
      for (std::size_t k = 0; k < kStrokes; ++k)
        if (fates.at(k) == static_cast<std::int8_t>(PathFate::Certain))
          one.fates.at(k) = fates.at(k);
      one.open = 0;
      if (trail != world.trails.end()) trail->ended = 1;
    }
    std::vector<Trail> left;
    for (const Trail& trail : world.trails) {
      const bool known = std::any_of(base.attempts.begin(), base.attempts.end(),
                                     [&](const Attempt& one) { return one.id == trail.id; });
      if (known) {
        left.push_back(trail);
        left.back().ended = 1;
        continue;
      }
      if (flaw_ == Flaw::DatabaseOnly || flaw_ == Flaw::IgnoresJournal) continue;
      if (surfaces(base, trail,
                   claims_of(trail, witness, &trail == &world.trails.back(), trail.first - 1))) {
        left.push_back(trail);
        left.back().ended = 1;
      }
    }
    world.trails = std::move(left);
    const Step step = step_of(base.state, JobEvent::Restarts);
    if (step == Step::ToInterrupted && flaw_ == Flaw::QueuesAgain) {
      base.state = JobState::Ready;
      ++base.segment;
      base.first = 0;
    } else if (step != Step::Refused) {
      take(base, step);
    }
    commit(world, base, what);
  }

  /// An attempt that the database lost. True: it is back.
  bool surfaces(Base& base, const Trail& trail, const IntentClaims& claims) {
    const std::int64_t doubt_upto = verdict_on(claims).doubt_upto;
    if (doubt_upto < trail.first) return false;
    Attempt back{.id = trail.id,
                 .blank = trail.blank,
                 .segment = trail.segment,
                 .first = trail.first,
                 .open = 0};
    set_fates(back, trail.first, static_cast<int>(doubt_upto), PathFate::InDoubt);
    base.attempts.push_back(back);
    if (surfacing_of(base.state, {1, base.blank}, 1, {1, trail.blank}) == Surfacing::Interrupts) {
      base.blank = trail.blank;
      base.segment = trail.segment;
      base.first = trail.first;
      take(base, step_of(base.state, JobEvent::IntentsSurface));
    }
    return true;
  }

  int depth_;
  Flaw flaw_;
  std::vector<Node> nodes_;
  std::unordered_set<std::string> seen_;
  std::size_t from_{0};
  Exploration result_;
};

}  // namespace

Exploration explore_knife(int depth, Flaw flaw) { return Explorer(depth, flaw).run(); }

}  // namespace popcut::testing
