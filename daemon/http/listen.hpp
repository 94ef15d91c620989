// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>

#include "core/result.hpp"

namespace popcut::daemon::http {

/// A listening socket. The destructor closes it, and removes the file of a unix socket that was
/// made here.
class Listener {
 public:
  /// @param endpoint "127.0.0.1:8631", "[::1]:0" (any free port) or "unix:/path"
  /// @param allow_remote  also allow addresses that are not loopback
  /// @retval Usage    not such an endpoint, or not a loopback address
  /// @retval Refused  the system refuses; the detail has the reason
  [[nodiscard]] static Result<Listener> open(const std::string& endpoint, bool allow_remote);
  /// A listening socket that was inherited (systemd).
  [[nodiscard]] static Result<Listener> adopt(int socket, bool allow_remote);
  ~Listener();
  Listener(Listener&& other) noexcept;
  Listener& operator=(Listener&&) = delete;

  [[nodiscard]] bool is_local() const { return is_local_; }
  [[nodiscard]] int family() const { return family_; }
  [[nodiscard]] std::uint16_t port() const { return port_; }
  /// "127.0.0.1:8631", "unix:/run/popcut.sock".
  [[nodiscard]] const std::string& name() const { return name_; }
  /// Hands the socket over; the caller closes it.
  [[nodiscard]] int release();

 private:
  explicit Listener(int socket) : socket_(socket) {}
  [[nodiscard]] Result<void> look(bool allow_remote);
  int socket_{-1};
  int family_{0};
  bool is_local_{false};
  std::uint16_t port_{0};
  std::string name_;
  std::string made_path_;
};

}  // namespace popcut::daemon::http
