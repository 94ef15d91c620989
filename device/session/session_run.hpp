// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "device/session/inquirer.hpp"
#include "device/session/pace.hpp"
#include "device/session/schedule.hpp"
#include "device/session/session.hpp"
#include "device/session/stroke_journal.hpp"

namespace popcut {

inline Error refused(std::string detail, ErrorReason reason = ErrorReason::None) {
  return {ErrorKind::Refused, "", std::move(detail), reason};
}

/// One session while it runs; call `run_session` instead.
class SessionRun {
 public:
  SessionRun(Transport& transport, const Machine& machine, const EncodedProgram& program,
             const SessionOptions& options)
      : transport_(transport),
        machine_(machine),
        program_(program),
        options_(options),
        inquirer_(transport, {options.reply_s, options.tries, 0.1, options.cancel,
                              program.dialect == Dialect::Hpgl ? '\r' : '\x03'}),
        journal_(program, machine, options),
        answers_(program.dialect == Dialect::Gpgl && transport.answers()),
        begun_(transport.now()),
        pace_(answers_) {}

  SessionEnd run();

 private:
  using Time = std::chrono::nanoseconds;

  // The phases.
  Result<void> phases();
  Result<void> connect();
  Result<void> check_identity();
  Result<void> check_blade();
  Result<void> check_limits();
  Result<void> settings();
  Result<void> search();
  Result<bool> found_marks();
  Result<void> geometry();
  Result<void> park();
  void lift_without_memory();
  [[nodiscard]] std::uint64_t byte_at(double seconds) const;
  [[nodiscard]] std::optional<std::size_t> likely_stroke();

  // Streaming.
  Result<void> send(std::span<const std::byte> bytes, std::uint64_t& count);
  Result<void> send(ByteRange range, std::uint64_t& at) {
    at = range.begin;
    return send(program_.view(range), at);
  }
  Result<void> send_program(std::uint64_t end);
  Result<void> send_until(std::uint64_t end);
  [[nodiscard]] std::uint64_t affordable();
  [[nodiscard]] bool cancel_asked() const {
    return options_.cancel != nullptr && options_.cancel->load(std::memory_order_relaxed);
  }
  [[nodiscard]] bool give_up_asked() const {
    return options_.give_up != nullptr && options_.give_up->load(std::memory_order_relaxed);
  }
  Result<void> give_up();

  // Holding.
  [[nodiscard]] bool pause_asked() const {
    return options_.pause != nullptr && options_.pause->load(std::memory_order_relaxed);
  }
  Result<void> hold();
  Result<void> stay();
  Result<void> lift();
  Result<void> synchronise();

  // The machine's state.
  Result<void> poll(), look();
  void note_ready(std::uint64_t bytes, Time asked_at);
  [[nodiscard]] Result<void> stuck() const;
  [[nodiscard]] Result<void> stopped(DeviceStatus status) const;
  Result<void> sit_out_pause();
  Result<void> check_resumed(double unseen_s);
  [[nodiscard]] std::optional<std::string> window_reply();
  Result<void> wait_ready(double whole_s, double left_s, double nap_s);
  Result<void> wait_ready(double whole_s, double left_s) {
    return wait_ready(whole_s, left_s, options_.poll_s);
  }
  Result<void> wait_ready(double whole_s) { return wait_ready(whole_s, whole_s); }

  /// Where the machine should be now, in seconds of the geometry by the model.
  [[nodiscard]] double model_s() {
    pace_.advance(transport_.now(), sent_s_);
    return pace_.at_s();
  }
  /// The longest that the machine can still need for what was sent.
  [[nodiscard]] double slowest_left_s() {
    pace_.advance(transport_.now(), sent_s_);
    return (sent_s_ - pace_.least_s()) / pace_.slow();
  }
  [[nodiscard]] double left_s() { return (sent_s_ - model_s()) / pace_.rate(); }

  void report(SessionPhase phase);
  [[nodiscard]] double mute_s() const {
    return mute_since_ ? to_seconds(transport_.now() - *mute_since_) : 0;
  }

  Transport& transport_;
  const Machine& machine_;
  const EncodedProgram& program_;
  const SessionOptions& options_;
  Inquirer inquirer_;
  StrokeJournal journal_;
  bool answers_;
  Time begun_;
  std::optional<std::string> window_said_;  ///< reply to U once the settings were sent
  bool asks_{false};                        ///< a person, how a pause ended
  Schedule plan_;
  SessionEnd end_;
  SessionPhase phase_{SessionPhase::Connecting};
  std::uint64_t accepted_{}, ready_bytes_{}, good_bytes_{};
  std::vector<ByteRange> left_out_;  ///< bytes of the program that this machine does not get
  std::uint64_t in_doubt_{};         ///< bytes after `accepted_`, if the last write failed
  DeviceStatus status_{DeviceStatus::Unknown};
  Pace pace_;
  Time next_poll_{};
  Time rested_at_{};                ///< when it came to rest, between two replies
  Time busy_at_{};                  ///< when it last said that it moves
  std::optional<Time> mute_since_;  ///< since when it accepts no bytes
  std::size_t next_command_{};      ///< first of `plan_.geometry` that was not sent
  double sent_s_{};                 ///< when the last command sent should end
  std::size_t strokes_passed_{};
};

}  // namespace popcut
