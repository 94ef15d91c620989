// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <functional>
#include <span>
#include <vector>

#include "daemon/devices/line_figures.hpp"
#include "device/port/transport.hpp"
#include "device/sim/sim_transport.hpp"

namespace popcut::daemon {

/// A simulated cutter whose clock runs `scale` times as fast as the clock on the wall; with a scale
/// of 0 it runs as fast as it can.
class PacedTransport final : public Transport {
 public:
  /// @param beat      called at least every 50 ms while time passes
  /// @param received  is given what the cutter took, before the call that sent it returns
  PacedTransport(SimTransport sim, double scale, std::function<void()> beat,
                 std::function<void(std::span<const std::byte>)> received);

  [[nodiscard]] WriteEnd write(std::span<const std::byte> bytes, Deadline until) override;
  [[nodiscard]] Result<std::vector<std::byte>> read(Deadline until) override;
  [[nodiscard]] std::chrono::nanoseconds now() const override;
  void wait(std::chrono::nanoseconds duration) override;

  [[nodiscard]] const SimCutter& cutter() const { return sim_.cutter(); }

 private:
  /// Where the cutter's clock should stand now.
  [[nodiscard]] std::chrono::nanoseconds due() const;
  void catch_up();
  /// Lets the clock on the wall come to where the cutter's clock is.
  void let_pass();

  SimTransport sim_;
  double scale_;
  std::function<void()> beat_;
  std::function<void(std::span<const std::byte>)> received_;
  std::chrono::steady_clock::time_point begun_;
};

/// Any transport, with a sign of life whenever it is used, and figures of it; long waits are cut
/// into short ones.
class BeatingTransport final : public Transport {
 public:
  BeatingTransport(Transport& inner, std::function<void()> beat, LineFigures* figures)
      : inner_(inner), beat_(std::move(beat)), figures_(figures) {}

  [[nodiscard]] WriteEnd write(std::span<const std::byte> bytes, Deadline until) override;
  [[nodiscard]] Result<std::vector<std::byte>> read(Deadline until) override;
  [[nodiscard]] std::chrono::nanoseconds now() const override { return inner_.now(); }
  void wait(std::chrono::nanoseconds duration) override;
  [[nodiscard]] bool answers() const override { return inner_.answers(); }
  [[nodiscard]] std::size_t in_transit() const override { return inner_.in_transit(); }

 private:
  Transport& inner_;
  std::function<void()> beat_;
  LineFigures* figures_;  ///< outlives it; may be null
};

}  // namespace popcut::daemon
