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

/// What is known about a stroke when a session has ended.
enum class StrokeFate : std::uint8_t {
  NotSent,  ///< no byte of it was accepted: it was not cut
  InDoubt,  ///< a byte of it was accepted: it may be cut, in part or whole
  Certain,  ///< it was cut: the device reported ready after it, or took a whole buffer more
};

/// What a session is doing.
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
/// "connecting", "sending the settings", "searching for the marks", "cutting", "paused on the
/// panel", "held", ...
[[nodiscard]] std::string_view name_of(SessionPhase phase);

struct SessionProgress {
  SessionPhase phase{};
  std::uint64_t strokes_done{};  ///< estimated by the model of the machine's motion
  std::uint64_t strokes{};
  double seconds_left{};  ///< estimated
  double mute_s{};  ///< time since the machine last accepted a byte; 0 if it accepts bytes now
  bool asks{};      ///< Held because only a person can tell whether the machine goes on: see `ask`
};

struct SessionOptions {
  double window_s{2};          ///< most motion, by estimate, sent ahead of the machine
  double poll_s{0.5};          ///< between status queries, as in the machines' own software
  double reply_s{1};           ///< to wait for one reply; the longest recorded one took 0.34 s
  int tries{3};                ///< queries without a valid answer before the session gives up
  double stuck_s{120};         ///< limit without an accepted byte or a change of status
  double pause_limit_s{3600};  ///< limit for a pause on the panel
  /// Set this to end the job at the next end of a stroke, with the tool up and parked, or at once
  /// if the machine accepts no bytes.
  const std::atomic<bool>* cancel{};
  /// Set this to end the job now, without waiting for the end of the stroke: the trailer (tool up
  /// and parked) follows the last whole command, and the stroke is in doubt.
  const std::atomic<bool>* give_up{};
  /// While this is set, nothing is sent beyond the next end of a stroke, where the tool is lifted
  /// and waits.
  const std::atomic<bool>* pause{};
  /// Called when a pause on the panel ended in a way that may have been a cancel: the machine is
  /// ready before it should be, or never said how the pause ended. It must set `pause`. The session
  /// then holds until `pause` is cleared (the machine goes on) or `cancel` is set. Without it, such
  /// a pause ends the job.
  std::function<void()> ask{};
  /// Called about every `poll_s`, and when the phase changes.
  std::function<void(const SessionProgress&)> progress;
  /// A run whose time counts: no waits for the machine on the way. For short ones.
  bool timed{false};
  /// Skips all earlier strokes: after the setup and the settings they changed, the tool moves, up,
  /// to the start of this one. Strokes keep their numbers in the whole program.
  std::size_t first_stroke{0};

  /// The journal. `intend` is called before any byte of the strokes up to `last_stroke` is sent,
  /// `settle` when more strokes are certain, or taken: a byte of their lines was accepted. Strokes
  /// count from 0; -1 is none. If one returns an error, the job ends with that error at the next
  /// end of a stroke, with the tool up and parked, and neither is called again.
  std::function<Result<void>(std::int64_t last_stroke)> intend{};
  std::function<Result<void>(std::int64_t certain, std::int64_t taken, std::uint64_t bytes)>
      settle{};
};

/// How a session ended. `fates`, the ledger, is always complete.
struct SessionEnd {
  std::optional<Error> error;     ///< none: all was sent and the machine has come to rest
  bool cancelled{false};          ///< ended early because `SessionOptions::cancel` was set
  bool confirmed{false};          ///< the machine itself reported ready after the last stroke
  std::vector<StrokeFate> fates;  ///< one per stroke; dots are never sent and stay NotSent
  std::string identity;           ///< its reply to FG
  /// After an error during the geometry: the stroke that the knife was most likely in, by the model
  /// corrected by what was seen. Counts from 0.
  std::optional<std::size_t> likely_stroke;
  std::vector<std::string> remarks;
  double seconds{};  ///< on the transport's clock
  /// How long settings, strokes and the way back took until the machine was at rest, as near as its
  /// replies tell; 0 for what was not reached.
  double setup_s{}, geometry_s{}, trailer_s{};
};

/// Sends a program to a cutter: asks for identity and status, sends the settings and waits until
/// the machine is ready; streams the geometry as fast as the machine accepts it, waits, sends the
/// trailer, waits.
///
/// It sends one query at a time and drops stale input before each. It polls the status while
/// streaming. Every 10 to 12 s of motion, at the end of a stroke, it lifts the tool and waits until
/// the machine is ready: all strokes before are then certain, and how long they took corrects the
/// model's speed, so that a stop takes effect within `window_s` on a slower machine too. After a
/// write that ended early it continues with the next byte; no byte is ever sent twice. Machines
/// that answer nothing (HPGL) are paced by the model of their motion alone.
///
/// Ends with
/// - Refused: registration marks not found; no media (before anything is cut, or when it runs out);
///   cancelled on the panel; paused for too long; another model than `machine`; or replies that are
///   not a status
/// - Timeout: no reply, no byte accepted, or not ready for too long
/// - DeviceGone: the transport reported it
/// - Internal: no memory; the machine still cuts what it has received
/// - OutOfRange: the machine or program cannot be modelled (see `SimCutter::make`), or there is no
///   stroke `first_stroke`
/// - an error of the journal
[[nodiscard]] SessionEnd run_session(Transport& transport, const Machine& machine,
                                     const EncodedProgram& program,
                                     const SessionOptions& options = {});

/// The ledger's rule. `ready_bytes` were accepted when the device last reported ready, `good_bytes`
/// when it last replied with a valid status, `accepted` in total.
[[nodiscard]] StrokeFate fate_of(ByteRange stroke, std::uint64_t ready_bytes,
                                 std::uint64_t good_bytes, std::uint64_t accepted,
                                 std::uint64_t buffer_bytes);

}  // namespace popcut
