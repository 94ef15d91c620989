// SPDX-License-Identifier: MIT
#pragma once

#include <sys/uio.h>

#include <chrono>
#include <span>

#include "core/result.hpp"
#include "daemon/client/address.hpp"

namespace popcut::client {

/// A connected socket; every wait has a deadline.
class Wire {
 public:
  using Clock = std::chrono::steady_clock;
  Wire() = default;
  ~Wire();
  Wire(Wire&& other) noexcept;
  Wire& operator=(Wire&& other) noexcept;
  Wire(const Wire&) = delete;
  Wire& operator=(const Wire&) = delete;

  /// @retval DeviceGone  no answer; the place is the address
  /// @retval Refused     access to the socket is denied
  [[nodiscard]] static Result<Wire> connect(const Address& address, double seconds);

  void deadline_in(double seconds);
  /// Bytes that came, 0 at the end. An errno below 0: -ETIMEDOUT, -ECONNRESET, ...
  [[nodiscard]] long read(std::span<const iovec> into);
  [[nodiscard]] long write(std::span<const iovec> from);
  [[nodiscard]] bool open() const { return fd_ >= 0; }
  void close();

 private:
  explicit Wire(int fd) : fd_(fd) {}
  /// 0, or an errno below 0.
  [[nodiscard]] int wait(short events) const;
  int fd_{-1};
  Clock::time_point deadline_{Clock::time_point::max()};
};

}  // namespace popcut::client
