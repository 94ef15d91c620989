// SPDX-License-Identifier: MIT
#pragma once

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "tests/support/process.hpp"

namespace popcut::testing {

/// The socket on which a service manager receives popcutd's notifications.
class ServiceManagerSocket {
 public:
  ServiceManagerSocket()
      : path_((folder_ / "notify").string()), socket_(::socket(AF_UNIX, SOCK_DGRAM, 0)) {
    sockaddr_un at{};
    at.sun_family = AF_UNIX;
    path_.copy(at.sun_path, sizeof at.sun_path - 1);
    if (::bind(socket_, reinterpret_cast<const sockaddr*>(&at), sizeof at) != 0)
      throw std::runtime_error("no socket: " + path_);
  }
  ~ServiceManagerSocket() { ::close(socket_); }
  ServiceManagerSocket(const ServiceManagerSocket&) = delete;
  ServiceManagerSocket& operator=(const ServiceManagerSocket&) = delete;

  /// What a daemon is started with that is to feed a watchdog.
  [[nodiscard]] std::vector<std::string> environment(double watchdog_s) const {
    return {"NOTIFY_SOCKET=" + path_, fmt::format("WATCHDOG_USEC={:.0f}", 1e6 * watchdog_s)};
  }
  /// How often the watchdog was fed since this was last asked.
  int feedings() {
    int count = 0;
    std::array<char, 512> room{};
    for (;;) {
      const ssize_t got = ::recv(socket_, room.data(), room.size(), MSG_DONTWAIT);
      if (got <= 0) return count;
      const std::string said(room.data(), static_cast<std::size_t>(got));
      count += said.find("WATCHDOG=1") != std::string::npos ? 1 : 0;
    }
  }

 private:
  TempFolder folder_;
  std::string path_;
  int socket_;
};

}  // namespace popcut::testing
