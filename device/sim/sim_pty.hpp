// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "core/result.hpp"
#include "device/sim/sim_transport.hpp"

namespace popcut {

/// A simulated cutter behind a pseudo terminal, in real time or a multiple of it. Other programs
/// open `path` like a cutter's serial port. A full buffer causes back-pressure.
class SimPty {
 public:
  /// @param speedup  seconds of the cutter per real second; above 0
  /// @retval Unwritable  no pseudo terminal is available
  [[nodiscard]] static Result<SimPty> open(SimTransport cable, double speedup = 1);
  SimPty(SimPty&& other) noexcept;
  SimPty& operator=(SimPty&&) = delete;
  SimPty(const SimPty&) = delete;
  SimPty& operator=(const SimPty&) = delete;
  ~SimPty();

  [[nodiscard]] const std::string& path() const { return path_; }
  /// Serves the other end for `duration` of real time. False: the cable was unplugged by a fault
  /// script, and the terminal hangs up.
  bool serve(std::chrono::milliseconds duration);
  [[nodiscard]] SimTransport& cable() { return cable_; }

 private:
  SimPty(SimTransport cable, double speedup) : cable_(std::move(cable)), speedup_(speedup) {}
  bool step();
  void close();

  SimTransport cable_;
  double speedup_{1};
  int main_{-1}, held_{-1};  ///< both ends: `held_` keeps it up while no program has it open
  std::string path_;
  std::vector<std::byte> waiting_, answers_;
  std::chrono::steady_clock::time_point begun_{std::chrono::steady_clock::now()};
};

}  // namespace popcut
