// SPDX-License-Identifier: MIT
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "core/result.hpp"
#include "device/port/transport.hpp"
#include "protocol/replies.hpp"

namespace popcut {

/// Asks a GPGL machine, one question at a time.
///
/// A reply does not say what it answers. So what is unread is dropped before each query, and
/// "ready" is believed only if two queries in a row are answered so, far enough apart for a reply
/// to an earlier, unanswered query to have come. "No media" too: a recorded session has a single
/// one in the middle of a cut (Portrait V1.00).
class Inquirer {
 public:
  struct Limits {
    double reply_s{1};
    int tries{3};
    double again_s{0.1};  ///< between a doubtful answer and the next query
    /// While it is set from outside, a machine that takes no query is not waited for.
    const std::atomic<bool>* hurry{};
  };
  Inquirer(Transport& transport, const Limits& limits) : transport_(transport), limits_(limits) {}

  /// None: the machine takes no data just now, not even a query; nothing is known of it.
  ///
  /// @retval Timeout     `tries` queries without an answer
  /// @retval Refused     `tries` answers that are no status, or that contradict each other
  /// @retval DeviceGone  the transport says so
  [[nodiscard]] Result<std::optional<DeviceStatus>> status();
  /// One reply to `query`, without its ETX. None: the machine takes no data just now.
  [[nodiscard]] Result<std::optional<std::string>> ask(std::string_view query);

  /// Drops what arrived unasked, before something that is answered of itself.
  [[nodiscard]] Result<void> forget() { return drain(); }
  /// The one reply that comes within `seconds`, without its ETX.
  ///
  /// @retval Timeout  none came
  [[nodiscard]] Result<std::string> await(double seconds) { return receive(seconds); }

  /// Sends what was not taken of a query, which must be whole before anything else follows it.
  /// True once nothing is owed.
  [[nodiscard]] Result<bool> pay_debt(Deadline until);

 private:
  [[nodiscard]] Result<void> drain();
  [[nodiscard]] Transport::WriteEnd begin(std::string_view query);
  [[nodiscard]] Result<std::string> receive(double seconds);
  [[nodiscard]] std::chrono::nanoseconds later(double seconds) const;

  Transport& transport_;
  Limits limits_;
  std::string owed_;  ///< bytes of a query that was taken in part
  bool late_reply_possible_{false};
};

}  // namespace popcut
