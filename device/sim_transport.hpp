// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "device/sim_cutter.hpp"
#include "device/transport.hpp"

namespace popcut {

/// Something that goes wrong on the cable or at the machine once `at_byte` bytes were accepted.
struct SimFault {
  enum class Kind : std::uint8_t {
    Unplug,      ///< nothing is accepted or answered any more
    ShortWrite,  ///< this write ends early, though there is room
    Nak,         ///< nothing is accepted for `seconds`
    Silence,     ///< replies are lost for `seconds`
    Garbage,     ///< `text` arrives unasked
    Pause,       ///< the panel's pause button, pressed again after `seconds` if above 0
    Cancel,      ///< pause, and cancel after `seconds`
    MediaOut,    ///< the sheet is pulled out, and loaded again after `seconds` if above 0
  };
  std::uint64_t at_byte{};
  Kind kind{};
  double seconds{};
  std::string text{};
};

/// The cable to a simulated cutter, on its virtual clock: a cut of 40 minutes takes milliseconds.
class SimTransport final : public Transport {
 public:
  explicit SimTransport(SimCutter cutter, std::vector<SimFault> faults = {});

  [[nodiscard]] WriteEnd write(std::span<const std::byte> bytes, Deadline until) override;
  [[nodiscard]] Result<std::vector<std::byte>> read(Deadline until) override;
  [[nodiscard]] std::chrono::nanoseconds now() const override { return cutter_.now(); }
  void wait(std::chrono::nanoseconds duration) override;

  [[nodiscard]] SimCutter& cutter() { return cutter_; }
  [[nodiscard]] const SimCutter& cutter() const { return cutter_; }
  /// A reset of the bus, a new cable: what was unplugged can be reached again.
  void replug() { unplugged_ = false; }

 private:
  enum class Button : std::uint8_t { Resume, Cancel, LoadMedia };
  struct Press {
    std::chrono::nanoseconds time{};
    Button button{};
  };

  void run_until(std::chrono::nanoseconds time);
  /// Faults that are due; true if this write must end here.
  bool strike();
  /// Bytes up to the next fault that is due by their count.
  [[nodiscard]] std::size_t before_fault(std::size_t bytes) const;

  SimCutter cutter_;
  std::vector<SimFault> faults_;  ///< by `at_byte`
  std::size_t next_fault_{};
  std::vector<Press> presses_;
  bool unplugged_{false};
  std::chrono::nanoseconds nak_until_{}, silent_until_{};
  std::string garbage_;
};

}  // namespace popcut
