// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "device/sim/sim_cutter.hpp"
#include "tests/support/usbfs_device.hpp"

namespace popcut::testing {

/// Something that goes wrong on the bus or at the machine once it has taken `at_byte` bytes.
struct UsbFault {
  enum class Kind : std::uint8_t {
    Stall,       ///< the endpoint outward halts
    BusError,    ///< the transfer ends with EPROTO
    Nak,         ///< nothing is taken for `seconds`
    Unplug,      ///< transfers end with ESHUTDOWN
    UnplugLate,  ///< transfers end with EPROTO, and then the device is gone
    SubmitFail,  ///< the kernel takes no transfer, once
    StallIn,     ///< the endpoint inward halts, once
    BusErrorIn,  ///< a transfer inward is lost
    Garbage,     ///< `text` arrives unasked
    Silence,     ///< replies are lost for `seconds`
    Pause,       ///< the panel's pause button, pressed again after `seconds`
    Cancel,      ///< pause, and cancel after `seconds`
    MediaOut,    ///< the sheet is pulled out
  };
  std::uint64_t at_byte{};
  Kind kind{};
  double seconds{};
  std::string text{};
};

/// The simulated cutter behind the endpoints of an emulated USB device, in real time: the same
/// model as behind `sim:NAME`.
class UsbCutter {
 public:
  UsbCutter(UsbfsDevice& device, SimCutter cutter, std::vector<UsbFault> faults = {});
  UsbCutter(const UsbCutter&) = delete;
  UsbCutter& operator=(const UsbCutter&) = delete;
  ~UsbCutter();

  /// Ends the thread; the cutter is then the caller's alone.
  void stop();
  /// Ends a `Nak`: data is taken again.
  void take_again();
  [[nodiscard]] SimCutter& cutter() { return cutter_; }
  /// A look at the running cutter.
  [[nodiscard]] std::uint64_t accepted_bytes();
  [[nodiscard]] std::size_t strokes();

 private:
  using Clock = std::chrono::steady_clock;

  UsbfsDevice::Took take(std::span<const std::byte> bytes);
  int strike();
  void run();
  void step();
  [[nodiscard]] SimCutter::Time elapsed() const { return Clock::now() - begun_; }

  UsbfsDevice& device_;
  std::mutex mutex_;
  SimCutter cutter_;
  std::vector<UsbFault> faults_;
  std::size_t next_fault_{};
  Clock::time_point begun_{Clock::now()};
  SimCutter::Time nak_until_{}, silent_until_{}, resume_at_{SimCutter::Time::max()},
      cancel_at_{SimCutter::Time::max()};
  bool dead_{false};           ///< nothing is taken any more: about to be unplugged
  std::vector<UsbFault> due_;  ///< what only the thread can do
  bool stop_{false};
  std::thread thread_;
};

}  // namespace popcut::testing
