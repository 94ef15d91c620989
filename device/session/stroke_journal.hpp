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

/// Reports to the hooks of `SessionOptions` what a session is about to send and what is known about
/// what it sent, converting byte counts to numbers of strokes. Without hooks everything may be
/// sent.
class StrokeJournal {
 public:
  StrokeJournal(const EncodedProgram& program, const Machine& machine,
                const SessionOptions& options)
      : program_(program), machine_(machine), options_(options) {}

  /// True if the bytes before `until` may be sent: the strokes they belong to are in the journal.
  [[nodiscard]] bool intend(std::uint64_t until);
  /// Reports what is known now, if it is more than before; the counts are those of `fate_of`.
  void settle(std::uint64_t ready_bytes, std::uint64_t good_bytes, std::uint64_t accepted);
  /// The error of a hook, after which nothing is reported.
  [[nodiscard]] const std::optional<Error>& failure() const { return failure_; }

 private:
  const EncodedProgram& program_;
  const Machine& machine_;
  const SessionOptions& options_;
  std::int64_t intended_{-1}, certain_{-1}, taken_{-1};
  std::optional<Error> failure_;
};

/// The first end of a stroke at or after `byte`; the start of the geometry counts as one.
[[nodiscard]] std::uint64_t stroke_end_after(const EncodedProgram& program, std::uint64_t byte);
/// The bytes that lift the tool where the last stroke before `byte` ends (`lift_after`); empty if
/// there is no such stroke.
[[nodiscard]] std::string lift_at(const EncodedProgram& program, std::uint64_t byte);

}  // namespace popcut
