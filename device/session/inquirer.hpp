// SPDX-License-Identifier: MIT
#pragma once

#include <atomic>
#include <optional>
#include <string>
#include <string_view>

#include "core/result.hpp"
#include "device/port/transport.hpp"
#include "protocol/replies.hpp"

namespace popcut {

/// Sends queries to a machine, one at a time, and reads the replies.
///
/// A reply does not say what it answers. So unread bytes are dropped before each query, and "ready"
/// counts only if it answers two queries in a row, far enough apart for a late reply to an earlier
/// query to have arrived. The same holds for "no media": a recording has a single one in the middle
/// of a cut (Portrait V1.00).
class Inquirer {
 public:
  struct Limits {
    double reply_s{1};
    int tries{3};
    double again_s{0.1};  ///< between a doubtful answer and the next query
    /// While this is set, a machine that accepts no query is not waited for.
    const std::atomic<bool>* hurry{};
    char reply_end{'\x03'};  ///< ETX; CR for HPGL
  };
  Inquirer(Transport& transport, const Limits& limits) : transport_(transport), limits_(limits) {}

  /// The status; none if the machine accepts no data at the moment, not even a query.
  ///
  /// @retval Timeout     `tries` queries without an answer
  /// @retval Refused     `tries` replies that are not a status, or that contradict each other
  /// @retval DeviceGone  the transport reports it
  [[nodiscard]] Result<std::optional<DeviceStatus>> status();
  /// One reply to `query`, without its ETX; none if the machine accepts no data at the moment.
  [[nodiscard]] Result<std::optional<std::string>> ask(std::string_view query);

  /// Drops unread bytes, before a command that is answered without a query. If the machine is late
  /// with its replies, waits for them first.
  [[nodiscard]] Result<void> forget();
  /// The one reply that comes within `seconds`, without its ETX.
  ///
  /// @retval Timeout  none came
  [[nodiscard]] Result<std::string> await(double seconds) { return receive(seconds); }

  /// Sends the rest of a query that was accepted in part; nothing else may follow before. True once
  /// the query is complete.
  [[nodiscard]] Result<bool> pay_debt(Deadline until);

 private:
  [[nodiscard]] Result<void> drain();
  [[nodiscard]] Transport::WriteEnd begin(std::string_view query);
  [[nodiscard]] Result<std::string> receive(double seconds);
  [[nodiscard]] std::chrono::nanoseconds later(double seconds) const;

  Transport& transport_;
  Limits limits_;
  std::string owed_;  ///< rest of a query that was accepted in part
  bool late_reply_possible_{false};
};

}  // namespace popcut
