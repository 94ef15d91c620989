// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "core/result.hpp"

namespace popcut {

/// A moment on the transport's own clock (`Transport::now`) by which a call must have returned.
using Deadline = std::chrono::nanoseconds;

[[nodiscard]] inline std::chrono::nanoseconds to_time(double seconds) {
  return std::chrono::nanoseconds(std::llround(seconds * 1e9));
}
[[nodiscard]] inline double to_seconds(std::chrono::nanoseconds time) {
  return std::chrono::duration<double>(time).count();
}

/// How a session reaches a cutter: over USB, a serial port, a file, a recording, or the simulator.
class Transport {
 public:
  virtual ~Transport() = default;

  /// The result of a write: `taken` counts the bytes that the device certainly accepted, also on
  /// error.
  struct WriteEnd {
    std::size_t taken{};
    std::optional<Error> error;  ///< Timeout with `taken` less than all is back-pressure
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
  /// False: nothing at the other end can answer (a file), so do not ask.
  [[nodiscard]] virtual bool answers() const { return true; }
  /// How many of the taken bytes may still be in the host's own buffers.
  [[nodiscard]] virtual std::size_t in_transit() const { return 0; }
};

}  // namespace popcut
