// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "core/result.hpp"

namespace popcut {

/// A moment on the transport's own clock (`Transport::now`) after which a call must have returned.
using Deadline = std::chrono::nanoseconds;

/// The only seam between bytes and a bus: USB, serial, a file, a recorded session, the simulator.
class Transport {
 public:
  virtual ~Transport();

  /// What became of a write: `taken` counts what the device certainly accepted, also on error.
  struct WriteEnd {
    std::size_t taken{};
    std::optional<Error> error;  ///< Timeout with `taken` short of the whole is back-pressure
    std::size_t in_doubt{};  ///< bytes after `taken` that it may have accepted too; 0 with Timeout
  };

  /// Sends `bytes`, blocking until all are accepted or the deadline has passed.
  [[nodiscard]] virtual WriteEnd write(std::span<const std::byte> bytes, Deadline until) = 0;
  /// Whatever has arrived, at least one byte, or Timeout at the deadline.
  [[nodiscard]] virtual Result<std::vector<std::byte>> read(Deadline until) = 0;
  /// Time on this transport's clock: real time for a bus, virtual time for the simulator.
  [[nodiscard]] virtual std::chrono::nanoseconds now() const = 0;
  /// Lets time pass on this transport's clock.
  virtual void wait(std::chrono::nanoseconds duration) = 0;
  /// False: nothing at the other end can answer (a file), so there is no use in asking.
  [[nodiscard]] virtual bool answers() const { return true; }
  /// Of the bytes that were taken, how many may still be on the way (in the host's own buffers).
  [[nodiscard]] virtual std::size_t in_transit() const { return 0; }
};

}  // namespace popcut
