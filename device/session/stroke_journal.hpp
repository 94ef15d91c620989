// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "core/machines/machine.hpp"
#include "core/result.hpp"
#include "device/session/session.hpp"
#include "protocol/encode.hpp"

namespace popcut {

/// Tells the hooks of `SessionOptions` what a session is about to send and what is known of what it
/// sent: from byte counts to numbers of strokes. Without hooks it says yes to everything.
class StrokeJournal {
 public:
  StrokeJournal(const EncodedProgram& program, const Machine& machine,
                const SessionOptions& options)
      : program_(program), machine_(machine), options_(options) {}

  /// Whether the bytes before `until` may be sent: the strokes they belong to are written down.
  [[nodiscard]] bool intend(std::uint64_t until);
  /// What is known now, told if there is more than before; the counts as `fate_of` takes them.
  void settle(std::uint64_t ready_bytes, std::uint64_t good_bytes, std::uint64_t accepted);
  /// The error of a hook; nothing is told any more.
  [[nodiscard]] const std::optional<Error>& failure() const { return failure_; }

 private:
  const EncodedProgram& program_;
  const Machine& machine_;
  const SessionOptions& options_;
  std::int64_t intended_{-1}, certain_{-1}, taken_{-1};
  std::optional<Error> failure_;
};

/// The first end of a stroke at or after `byte`; the begin of the geometry counts as one.
[[nodiscard]] std::uint64_t stroke_end_after(const EncodedProgram& program, std::uint64_t byte);
/// What lifts the tool where the last stroke before `byte` ends (`lift_after`); empty: there is
/// none.
[[nodiscard]] std::string lift_at(const EncodedProgram& program, std::uint64_t byte);

/// `run_session` from `options.first_stroke` on.
[[nodiscard]] SessionEnd run_rest(Transport& transport, const Machine& machine,
                                  const EncodedProgram& program, const SessionOptions& options);

}  // namespace popcut
