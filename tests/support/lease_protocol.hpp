// SPDX-License-Identifier: MIT
#pragma once

#include "daemon/jobs/intents.hpp"
#include "daemon/jobs/resume.hpp"
#include "daemon/jobs/rules.hpp"
#include "tests/support/lease_world.hpp"

namespace popcut::testing::lease {

using daemon::JobState;
using daemon::PathFate;
using Byte = std::uint8_t;

inline constexpr auto kNotSent = static_cast<Byte>(PathFate::NotSent);
inline constexpr auto kDoubt = static_cast<Byte>(PathFate::InDoubt);
inline constexpr auto kCertain = static_cast<Byte>(PathFate::Certain);

// The rules, by their names.
inline constexpr const char* kCutTwice = "a stroke of a paper is cut twice, and nobody said so";
inline constexpr const char* kUncommitted = "the knife moves before its START is committed";
inline constexpr const char* kNotPressed = "a knife moves where nobody pressed START";
inline constexpr const char* kStartOver = "the knife begins although its START is no longer valid";
inline constexpr const char* kOtherArm = "a START uses what another epoch armed";
inline constexpr const char* kOffered = "a paper that was started is offered as unstarted";
inline constexpr const char* kUnrecorded =
    "a stroke that was cut is neither in the record nor in a journal";
inline constexpr const char* kFalseNotSent = "a stroke that was cut is recorded as not sent";
inline constexpr const char* kFalseCertain = "a stroke that was not cut is recorded as certain";
inline constexpr const char* kLateTruth =
    "a cut that was finished, and that nobody superseded, is not done";
inline constexpr const char* kOverruled = "a sheet that a person called not good is done";
inline constexpr const char* kSuperseded = "the end of a superseded attempt changes a newer one";
inline constexpr const char* kNotCut = "a job is done, but a sheet of it is not cut";
inline constexpr const char* kOnePaper = "two knives are in one paper";
inline constexpr const char* kOneName = "two processes hold the lease of one node";
inline constexpr const char* kOldEpoch =
    "a process starts though another has its node's newest epoch";
inline constexpr const char* kOutOfStep =
    "a node with a lease cuts what the database calls lost or unknown";
inline constexpr const char* kNobodyCuts =
    "the database calls a job cutting that its node does not cut";
inline constexpr const char* kHeldUnknown = "knife and database disagree whether the cut is held";
inline constexpr const char* kCancelLost = "a cancel is forgotten";

inline constexpr int kClone = 2;

[[nodiscard]] constexpr int node_of(int process) { return process == kClone ? 0 : process; }
[[nodiscard]] constexpr Byte folder_of(int process) { return static_cast<Byte>(process + 1); }
[[nodiscard]] constexpr std::size_t at(int index) { return static_cast<std::size_t>(index); }

[[nodiscard]] inline bool cuts(const Job& job) {
  return job.state == JobState::Cutting || job.state == JobState::Paused;
}
[[nodiscard]] inline bool moves(const Process& one) {
  return one.doing == Doing::Cutting || one.doing == Doing::Held;
}
[[nodiscard]] inline bool at_place(const Job& job, const Made& made) {
  return job.sheet == made.sheet && job.blank == made.blank && job.segment == made.segment;
}

[[nodiscard]] inline bool same_place(const Made& a, const Made& b) {
  return a.sheet == b.sheet && a.blank == b.blank && a.segment == b.segment;
}

/// What the database does for nodes, and what nodes do, each a change of the world that it is
/// given. `p` is a process, `id` an attempt. Whether it may be done is up to the caller, but where
/// a `may_` says it.
class Rules {
 public:
  Rules(World& world, Flaw flaw) : world_(world), flaw_(flaw) {}

  /// The rule that a change itself broke; nullptr: none.
  [[nodiscard]] const char* broken() const { return broken_; }
  [[nodiscard]] bool unchecked_marks() const { return flaw_ == Flaw::MarkUnchecked; }

  // What is looked at first.
  /// Whether the database takes a call of this epoch.
  [[nodiscard]] bool newest(int p, Byte epoch) const;
  /// Whether the process reaches the database, and is the node's newest.
  [[nodiscard]] bool calls(int p) const;
  /// Whether it has a lease besides, and has told its journals: it may arm.
  [[nodiscard]] bool works(int p) const;
  /// Whether all nodes told their journals since the database went back.
  [[nodiscard]] bool reported() const;
  /// Whether nobody acted since the attempt was open, or lost with its node's lease.
  [[nodiscard]] bool stands(int id) const;

  // The job.
  void take(JobState state);
  void next_sheet(bool said);

  // The record of an attempt.
  /// START. False: refused.
  bool commit_start(int p, Byte epoch, int id);
  /// Strokes up to `taken` are cut, those up to `intended` are about to be. It only grows.
  void mark(int id, int taken, int intended);
  /// False: the attempt has ended, and the end is not written.
  bool write_end(int id, End result, int taken);
  /// A START of which nothing was sent.
  void revoke_start(int p);

  // The knife.
  void cut(int p);
  void stroke(int p);
  /// At the end of its stroke.
  void stop(int p);
  /// The end is told, or there is none.
  void rest(int p);

  // Leases.
  [[nodiscard]] bool may_begin(int p) const;
  void begin(int p);
  /// What the node left whose lease is over.
  void sweep(int node);
  /// After `begin`: what older epochs of this node left, and what its journals know.
  void recover(int p);

 private:
  void go_to(const Made& made);
  void interrupt();
  void close(int id, End end, int doubt_upto);
  void lose(int id, End end, int doubt_upto);
  [[nodiscard]] bool may_commit(int p, Byte epoch, int id) const;
  [[nodiscard]] Byte next_epoch() const;
  void take_up(int p, int id);
  void match_state(int p);
  [[nodiscard]] int doubt_upto(int p, int id) const;
  void close_by_journal(int p, int id);
  void bring_back(int p, int id, bool running);
  void reopen(int p, int id);

  World& world_;
  Flaw flaw_;
  const char* broken_{nullptr};
};
}  // namespace popcut::testing::lease
