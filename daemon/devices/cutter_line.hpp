// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/machines/machine.hpp"
#include "core/result.hpp"
#include "daemon/config/config.hpp"
#include "daemon/devices/paced_transport.hpp"
#include "daemon/files/held_folder.hpp"
#include "device/port/device_id.hpp"
#include "device/sim/sim_faults.hpp"
#include "device/sim/trace.hpp"
#include "device/usb/usb_bus.hpp"

namespace popcut::daemon {

/// How a cutter is reached: its machine, and a way to open it for one sheet.
struct CutterLine {
  DeviceId device;
  Machine machine;
  double time_scale{0};            ///< simulated
  std::vector<SimFault> faults{};  ///< simulated; of the next sheet only
  HeldFolder traces{};             ///< simulated; none: no trace is kept
  std::shared_ptr<UsbBus> bus{};   ///< of a USB device
  std::string file{};              ///< where the program goes, if the device is a file
  [[nodiscard]] bool simulated() const { return device.kind == DeviceKind::Simulated; }
};

/// The line of a configured device that is simulated or a port.
///
/// @retval Usage, OutOfRange, Malformed  its id, machine or fault script is invalid
[[nodiscard]] Result<CutterLine> configured_line(const DeviceConfig& config,
                                                 const std::vector<std::string>& tables);

/// An open line, for one sheet. popcutd's cutters and 'popcut cut --direct' open it here.
class OpenLine {
 public:
  /// @param attempt  of the sheet, for the trace
  /// @param figures  counts what goes over it; outlives it
  /// @retval DeviceGone, Refused  as the transports say
  [[nodiscard]] static Result<OpenLine> open(CutterLine& line, const std::string& attempt,
                                             std::array<double, 2> area_mm,
                                             const std::function<void()>& beat,
                                             LineFigures* figures = nullptr);
  OpenLine(OpenLine&&) = default;
  OpenLine& operator=(OpenLine&&) = default;
  OpenLine(const OpenLine&) = delete;
  OpenLine& operator=(const OpenLine&) = delete;
  ~OpenLine();

  [[nodiscard]] Transport& transport() { return *beating_; }
  /// What the simulated cutter did; none for others.
  [[nodiscard]] std::optional<Trace> trace() const;
  /// Gives a file its name; nothing for others.
  [[nodiscard]] Result<void> finish();
  /// Keeps what a simulated cutter did, where the configuration wants it.
  void keep_trace(const CutterLine& line, const std::string& attempt) const;

 private:
  OpenLine() = default;
  std::shared_ptr<int> log_;  ///< received.log
  std::unique_ptr<Transport> transport_;
  std::unique_ptr<BeatingTransport> beating_;
};

}  // namespace popcut::daemon
