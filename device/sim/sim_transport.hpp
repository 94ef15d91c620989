// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "device/port/transport.hpp"
#include "device/sim/sim_cutter.hpp"
#include "device/sim/sim_faults.hpp"

namespace popcut {

/// The cable to a simulated cutter, on a virtual clock: a cut of 40 minutes takes milliseconds.
class SimTransport final : public Transport {
 public:
  explicit SimTransport(SimCutter cutter, std::vector<SimFault> faults = {});

  [[nodiscard]] WriteEnd write(std::span<const std::byte> bytes, Deadline until) override;
  [[nodiscard]] Result<std::vector<std::byte>> read(Deadline until) override;
  [[nodiscard]] std::chrono::nanoseconds now() const override { return cutter_.now(); }
  void wait(std::chrono::nanoseconds duration) override;

  [[nodiscard]] SimCutter& cutter() { return cutter_; }
  [[nodiscard]] const SimCutter& cutter() const { return cutter_; }
  /// When a fault last struck.
  [[nodiscard]] std::optional<std::chrono::nanoseconds> struck() const { return struck_; }
  /// Plugs the cutter in again.
  void replug() { unplugged_ = false; }

 private:
  enum class Button : std::uint8_t { Resume, Cancel, LoadMedia, Replug };
  struct Press {
    std::chrono::nanoseconds time{};
    Button button{};
  };

  void run_until(std::chrono::nanoseconds time);
  void run_clock(std::chrono::nanoseconds time);
  /// Triggers the faults that are due by accepted bytes.
  void strike();
  /// Triggers the faults that are due by started strokes.
  void strike_paths();
  void strike(const SimFault& fault);
  /// How many of `bytes` may be accepted before the next fault by bytes.
  [[nodiscard]] std::size_t before_fault(std::size_t bytes) const;

  SimCutter cutter_;
  std::vector<SimFault> faults_;       ///< by `at_byte`
  std::vector<SimFault> path_faults_;  ///< by `at_path`
  std::size_t next_fault_{}, next_path_fault_{};
  std::vector<Press> presses_;
  bool unplugged_{false}, write_ends_{false}, stalls_{false};
  std::chrono::nanoseconds nak_until_{}, silent_until_{};
  std::optional<std::chrono::nanoseconds> struck_;
  std::string garbage_;
};

}  // namespace popcut
