// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <type_traits>

#include "daemon/model/model.hpp"

namespace popcut::testing::lease {

// The world of the model: one job of two sheets with two strokes each, two nodes with one cutter
// each, and a third popcutd that runs with a copy of the first one's state folder.
inline constexpr int kNodes = 2;
inline constexpr int kProcesses = 3;
inline constexpr int kSheets = 2;
inline constexpr int kBlanks = 2;    // of each sheet
inline constexpr int kSegments = 2;  // of each blank
inline constexpr int kStrokes = 2;   // of each sheet
inline constexpr int kAttempts = 3;  // of the whole job, at most

/// How much is explored.
struct Bounds {
  int faults{1};            ///< that may happen on the way to a state
  int attempts{kAttempts};  ///< how often START is pressed, at most
  std::size_t states{};     ///< after so many no more are looked for
};

/// A rule of the protocol that is broken on purpose.
enum class Flaw : std::uint8_t {
  None,
  EpochUnchecked,         ///< the database does not ask whether a node's epoch is its newest
  IdentityUnchecked,      ///< another process may take a node's name while its lease lives
  ArmSurvivesRestart,     ///< a new epoch leaves armed what the old one armed
  SendsBeforeCommit,      ///< the knife moves when START is pressed, not when it is committed
  StartsOnLostAnswer,     ///< without an answer to START the knife moves
  StartsOnLateAnswer,     ///< the answer to START counts however late it comes
  StartDecidedTooEarly,   ///< whether a START was committed is read while it still may be
  HeartbeatRevives,       ///< a heartbeat revives a lease that is over
  SweepsTheLiving,        ///< a node whose lease lives is swept
  SweepMakesReady,        ///< a lease that is over makes the sheet ready instead of interrupted
  SweepKeepsNotSent,      ///< a lease that is over leaves strokes as not sent instead of in doubt
  SweepForgetsCancel,     ///< a lease that is over forgets that a person cancels
  MarkUnchecked,          ///< marks of any epoch and of attempts that have ended are written
  EndUnchecked,           ///< an end is written although the attempt was ended and superseded
  EndMovesTwice,          ///< an end that is told twice moves the job twice
  TakesUpSuperseded,      ///< a node takes up its cut though a person acted since
  OverrulesNotGood,       ///< that a person called a sheet not good is not an act
  TakesUpHeldAsCutting,   ///< a held cut is taken up as one that moves
  JournalLoses,           ///< after the database went back, it is believed, not the journals
  JournalForgotten,       ///< a journal is removed when its end is committed
  ForgetsRunning,         ///< of a cut that goes on, the journal is not told
  TakesBackByGuess,       ///< what is open and not cut counts as a START of which nothing was sent
  ArmsBeforeAllReported,  ///< after the database went back, nodes arm before all have reported
  GoesOnAfterRestore,     ///< nodes do not begin again when the database went back
  CopyBelieved,           ///< a copied journal is believed as if it were the original
};

enum class End : std::uint8_t { None, Done, Stopped, Lost, Crash, Superseded, Refused };
enum class Lease : std::uint8_t { Over, Live };
enum class Doing : std::uint8_t { Idle, Starting, Unsure, Cutting, Held, Ended };
enum class Request : std::uint8_t { UnderWay, Refused, Committed };
enum class Stray : std::uint8_t { None, Start, Mark, End };
enum class Asked : std::uint8_t { Nothing, Pause, Cancel };

// All are plain bytes, so that a state is a string of bytes.
struct Attempt {
  std::uint8_t present{}, started{}, open{}, epoch{};
  End end{};
  std::array<std::uint8_t, kStrokes> fates{};  ///< PathFate
};

struct Node {
  std::uint8_t epoch{};
  Lease lease{};
  std::uint8_t folder{};  ///< whose state folder: 1 + process; 0: none yet
  std::uint8_t begun{};   ///< since the database last went back
  std::uint8_t owes{};    ///< the folder that has not told its journals since then; 0: none
};

struct Job {
  daemon::JobState state{};
  std::uint8_t sheet{}, blank{}, segment{}, first{};
  Asked asked{};
  std::uint8_t not_good{};   ///< a person said so of this blank
  std::uint8_t all_doubt{};  ///< nothing is known of this blank
  std::uint8_t arm{};        ///< the epoch that armed it; 0: none
  std::uint8_t arm_node{};   ///< of that epoch
};

struct Database {
  Job job{};
  std::array<Node, kNodes> nodes{};
  std::array<Attempt, kAttempts> attempts{};
  std::array<std::uint8_t, kSheets> said{};  ///< a person finished this sheet
};

/// A popcutd. What is not in its state folder goes with the process.
struct Process {
  std::uint8_t up{}, linked{};
  std::uint8_t epoch{};      ///< 0: it has no lease
  std::uint8_t recovered{};  ///< it has told its journals in this epoch
  std::uint8_t fresh{};      ///< by its own clock its lease lives
  std::uint8_t forgotten{};  ///< the database went back to before this epoch
  Doing doing{};
  std::uint8_t id{};  ///< of the attempt that it does
  Request request{};  ///< while it starts
  End result{};       ///< once it ended
  std::uint8_t taken{}, intended{};
  std::array<std::uint8_t, kAttempts> journal{};  ///< 0: none; else 1 + strokes that are intended
};

/// What an attempt is of: the head of its journal. Also what is so, whoever knows it.
struct Made {
  std::uint8_t process{}, sheet{}, blank{}, segment{}, first{};
  std::uint8_t committed{};  ///< its START was, in some database
  std::uint8_t cut_upto{};   ///< strokes first .. cut_upto - 1 are cut
  std::uint8_t complete{};  ///< it was cut to its end, and its process still knew that when it told
};

/// A message whose sender has given up, but which may still arrive.
struct Message {
  Stray kind{};
  std::uint8_t process{}, epoch{}, id{};
  std::uint8_t fresh{};  ///< the job has not changed since it was sent
  std::uint8_t taken{}, intended{};
  End result{};
};

struct World {
  Database now{};
  Database copy{};  ///< what a standby or a backup has
  std::uint8_t has_copy{}, faults{}, next_id{}, cloned{}, cancelled{};
  std::array<Process, kProcesses> processes{};
  std::array<Made, kAttempts> made{};
  Message stray{};
  std::array<std::uint8_t, kSheets> left{};  ///< a person left strokes of this sheet uncut
  // By sheet, blank and stroke.
  std::array<std::array<std::array<std::uint8_t, kStrokes>, kBlanks>, kSheets> cut{}, allowed{};
};
static_assert(std::is_trivially_copyable_v<World> &&
              std::has_unique_object_representations_v<World>);

/// A step from one state to the next.
enum class Do : std::uint8_t {
  Begin0,  ///< there is a job
  // What heals, in the order in which it does.
  CloneStops,
  Restart,
  Reconnect,
  StartArrives,
  AnswerArrives,
  StrayArrives,
  BeatFails,
  LeaseEnds,
  Begins,
  Recovers,
  Resolves,
  Guesses,
  Notices,
  Strokes,
  Intends,
  Stops,
  Holds,
  Tells,
  Sweeps,
  Resumes,
  Disarms,
  Skips,
  // What else may happen.
  StrayLost,
  BeatArrives,
  OwnClockEnds,
  Arms,
  PressesStart,
  Pauses,
  Cancels,
  Confirms,
  SaysNotGood,
  TakesNewBlank,
  ResumesFrom,
  GoesBack,
  // Faults. Each counts.
  Dies,
  LinkBreaks,
  StartLost,
  StartDelayed,
  StartRepeated,
  MarkDelayed,
  MarkRepeated,
  EndUnanswered,
  EndDelayed,
  EndRepeated,
  BeatsSlow,
  CopyMade,
  Cloned,
};
inline constexpr auto kFirstFault = Do::Dies;
inline constexpr auto kLastHealing = Do::Skips;

struct Step {
  Do what{};
  std::uint8_t process{}, detail{};
};

/// The step in words.
[[nodiscard]] std::string sentence(const Step& step);

/// The state from which all others follow: the job is ready, both nodes have a lease.
[[nodiscard]] World first_world();

/// All steps from `world` within `bounds`. `found` gets each with where it leads,
/// and which rule the step itself broke (nullptr: none).
void each_step(const World& world, const Bounds& bounds, Flaw flaw,
               const std::function<void(const Step&, World&, const char* broken)>& found);

/// The rule that `world` breaks; nullptr: none.
[[nodiscard]] const char* broken_rule(const World& world);

[[nodiscard]] bool has_ended(const World& world);

/// Gives the same name to all worlds that differ in nothing but the numbers of epochs and in what
/// nobody looks at any more.
void tidy(World& world);

}  // namespace popcut::testing::lease
