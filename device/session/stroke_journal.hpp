// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

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
      : program_(program),
        machine_(machine),
        options_(options),
        lines_(popcut::first_lines(program)) {}

  /// True if the bytes before `until` may be sent: the strokes they belong to are in the journal.
  [[nodiscard]] bool intend(std::uint64_t until);
  /// Reports what is known now, if it is more than before; the counts are those of `fate_of`.
  void settle(std::uint64_t ready_bytes, std::uint64_t good_bytes, std::uint64_t accepted);
  /// For each stroke, where its first line begins: the bytes before cut nothing.
  [[nodiscard]] const std::vector<std::uint64_t>& first_lines() const { return lines_; }
  /// The first place at or after `byte` where the tool can stay up: the end of a stroke, or after
  /// the move to the next. The start of the geometry counts as one.
  [[nodiscard]] std::uint64_t stop_after(std::uint64_t byte) const;
  /// The bytes that lift the tool at such a place (`lift_after`); empty where it is up.
  [[nodiscard]] std::string lift_at(std::uint64_t byte) const;
  /// The error of a hook, after which nothing is reported.
  [[nodiscard]] const std::optional<Error>& failure() const { return failure_; }

 private:
  /// How many strokes begin before `byte`, settings included.
  [[nodiscard]] std::int64_t begun_before(std::uint64_t byte) const;

  const EncodedProgram& program_;
  const Machine& machine_;
  const SessionOptions& options_;
  const std::vector<std::uint64_t> lines_;
  std::int64_t intended_{-1}, certain_{-1}, taken_{-1};
  std::optional<Error> failure_;
};

}  // namespace popcut
