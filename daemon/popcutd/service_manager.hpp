// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace popcut::daemon {

/// Messages to systemd and the sockets it passes: sd_notify(3), sd_listen_fds(3), without its
/// library.
class ServiceManager {
 public:
  /// Reads NOTIFY_SOCKET, WATCHDOG_USEC, LISTEN_FDS and the like, and takes them out of the
  /// environment, so that no child has them.
  [[nodiscard]] static ServiceManager from_environment();

  // Most callers go on without the manager. NOLINTBEGIN(modernize-use-nodiscard)
  /// Sends a state, as in "READY=1\nSTATUS=serving". Nothing happens without a manager; false if
  /// there is one and it cannot be reached.
  bool tell(std::string_view state) const;
  /// `text` without control characters.
  bool tell_status(const std::string& text) const;
  // NOLINTEND(modernize-use-nodiscard)
  [[nodiscard]] bool present() const { return !socket_.empty(); }
  /// The interval at which it expects a sign of life, or nothing.
  [[nodiscard]] std::optional<double> watchdog_s() const { return watchdog_s_; }
  /// Listening sockets that it hands over, each marked to be closed in children.
  [[nodiscard]] const std::vector<int>& sockets() const { return sockets_; }

 private:
  std::string socket_;  ///< with a NUL in front where it is an abstract one
  std::optional<double> watchdog_s_{};
  std::vector<int> sockets_{};
};

}  // namespace popcut::daemon
