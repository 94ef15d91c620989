// SPDX-License-Identifier: MIT
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/machines/machine.hpp"
#include "core/result.hpp"
#include "device/port/transport.hpp"
#include "protocol/encode.hpp"

namespace popcut {

/// What is known of a stroke when a session has ended.
enum class StrokeFate : std::uint8_t {
  NotSent,  ///< no byte of it was accepted: it was not cut
  InDoubt,  ///< a byte of it was accepted: it may be cut, in part or whole
  Certain,  ///< the device said ready after it, or took a whole buffer of further bytes: it was cut
};

/// Where a session is.
enum class SessionPhase : std::uint8_t {
  Connecting,
  Settings,
  Searching,
  Cutting,
  Paused,
  Held,
  Finishing,
  Parking
};
/// "connecting", "sending the settings", "searching the marks", "cutting", "paused on the panel",
/// "held", ...
[[nodiscard]] std::string_view name_of(SessionPhase phase);

struct SessionProgress {
  SessionPhase phase{};
  std::uint64_t strokes_done{};  ///< estimated by the model of the machine's motion
  std::uint64_t strokes{};
  double seconds_left{};  ///< estimated
  double mute_s{};        ///< since the machine last took a byte, if it takes none now; else 0
};

struct SessionOptions {
  double window_s{2};          ///< most estimated motion that is sent ahead of the machine's clock
  double poll_s{0.5};          ///< between status queries, as the machines' own software does
  double reply_s{1};           ///< for one reply; the longest recorded one took 0.34 s
  int tries{3};                ///< queries without a sensible answer before the session gives up
  double stuck_s{120};         ///< without a byte being taken or a status that moves on
  double pause_limit_s{3600};  ///< for a pause on the panel
  /// Set from outside to end the job at the next end of a stroke, with the tool up and parked;
  /// where the machine takes nothing, at once.
  const std::atomic<bool>* cancel{};
  /// Set from outside to end the job now, where no end of a stroke can be waited for: the machine
  /// is sent its trailer, tool up and parked, after the last whole command; the stroke is in doubt.
  const std::atomic<bool>* give_up{};
  /// While it is set from outside, nothing is sent beyond the next end of a stroke, where the tool
  /// is lifted and waits.
  const std::atomic<bool>* pause{};
  /// Called about every `poll_s`, and when the phase changes.
  std::function<void(const SessionProgress&)> progress;
  /// Earlier strokes are left out: after the setup and what they changed of it the tool goes, up,
  /// to where this one begins. Numbers of strokes stay those of the whole program.
  std::size_t first_stroke{0};

  /// The journal. `intend` is called before any byte of the strokes up to `last_stroke` is sent
  /// (from where the call before ended), `settle` when more of them are certain or taken; strokes
  /// are counted from 0, -1 is none. When one returns an error, the job ends with that error at the
  /// next end of a stroke, with the tool up and parked; neither is called again.
  std::function<Result<void>(std::int64_t last_stroke)> intend{};
  std::function<Result<void>(std::int64_t certain, std::int64_t taken, std::uint64_t bytes)>
      settle{};
};

/// How a session ended. The ledger is there in any case.
struct SessionEnd {
  std::optional<Error> error;     ///< none: all was sent and the machine has come to rest
  bool cancelled{false};          ///< ended early because `SessionOptions::cancel` was set
  bool confirmed{false};          ///< the machine itself said that it is ready after the trailer
  std::vector<StrokeFate> fates;  ///< one a stroke of the program; dots, never sent, stay NotSent
  std::string identity;           ///< what it answered to FG
  std::vector<std::string> remarks;
  double seconds{};  ///< on the transport's clock
};

/// Sends a program to a cutter: identity and status, settings back to back, wait until ready,
/// geometry against the machine's own back-pressure without waiting, wait, trailer, wait.
///
/// One query is under way at a time; stale input is dropped before each. The status is asked for
/// while streaming. A write that ends early goes on with its next byte; nothing is ever sent twice.
/// Machines that answer nothing (HPGL) are paced by the model of their motion alone.
///
/// Ends with
/// - Refused: registration marks not found; no media (before anything is cut, or when it runs out),
/// cancelled on the panel, paused
///   for too long, another model than `machine`, or replies that are no status
/// - Timeout: no reply, or no byte taken, or not ready for too long
/// - DeviceGone: the transport says so
/// - Internal: no memory; what the machine has it still cuts
/// - OutOfRange: the machine or program cannot be modelled (see `SimCutter::make`), or there is no
///   stroke `first_stroke`
/// - what the journal said
[[nodiscard]] SessionEnd run_session(Transport& transport, const Machine& machine,
                                     const EncodedProgram& program,
                                     const SessionOptions& options = {});

/// The ledger's rule. `ready_bytes` were accepted when the device last said ready; `good_bytes`
/// when it last answered with a lawful status; `accepted` in all.
[[nodiscard]] StrokeFate fate_of(ByteRange stroke, std::uint64_t ready_bytes,
                                 std::uint64_t good_bytes, std::uint64_t accepted,
                                 std::uint64_t buffer_bytes);

}  // namespace popcut
