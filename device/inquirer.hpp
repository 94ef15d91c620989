// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "core/result.hpp"
#include "device/transport.hpp"
#include "protocol/replies.hpp"

namespace popcut {

/// Asks a GPGL machine, one question at a time.
///
/// A reply does not say what it answers. So what is unread is dropped before each query, and "ready"
/// is believed only if two queries in a row are answered so, far enough apart for a reply to an
/// earlier, unanswered query to have come. "No media" too: a recorded session has a single one in
/// the middle of a cut (Portrait V1.00).
class Inquirer {
 public:
  struct Limits {
    double reply_s{1};
    int tries{3};
    double again_s{0.1};  ///< between a doubtful answer and the next query
  };
  Inquirer(Transport& transport, const Limits& limits) : transport_(transport), limits_(limits) {}

  /// @retval Timeout     `tries` queries without an answer, or no room for a query
  /// @retval Refused     `tries` answers that are no status
  /// @retval DeviceGone  the transport says so
  [[nodiscard]] Result<DeviceStatus> status();
  /// One reply to `query`, without its ETX.
  [[nodiscard]] Result<std::string> ask(std::string_view query);

 private:
  [[nodiscard]] Result<void> drain();
  [[nodiscard]] Result<void> send(std::string_view query);
  [[nodiscard]] Result<std::string> receive();
  [[nodiscard]] std::chrono::nanoseconds later(double seconds) const;

  Transport& transport_;
  Limits limits_;
  bool late_reply_possible_{false};
};

}  // namespace popcut
