// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/result.hpp"
#include "device/usb/usb_device.hpp"
#include "device/usb/usb_transport.hpp"

namespace popcut {

/// The USB of this computer. Its own thread handles what the bus reports: finished transfers, and
/// devices that are plugged in and out.
///
/// You may call all functions from any thread. A transport keeps its bus alive.
class UsbBus {
 public:
  /// @retval DeviceGone  no USB is available (a container, a virtual machine without it)
  [[nodiscard]] static Result<UsbBus> open();

  /// The connected devices that accept bytes as a cutter does, including printers.
  [[nodiscard]] std::vector<UsbDevice> devices() const;

  /// The device that an id names, by serial or by port.
  ///
  /// @retval DeviceGone  no such device
  /// @retval Refused     two devices have this serial
  [[nodiscard]] Result<UsbDevice> find(const std::string& id) const;

  /// Detaches the device's kernel driver (and attaches it again at the end) and claims its
  /// interface. Sends nothing to it. Errors are those of `find`, and:
  ///
  /// @retval Refused  another program uses it; no permission; or the kernel refuses
  [[nodiscard]] Result<std::unique_ptr<UsbTransport>> connect(const std::string& id) const;

  /// How often devices were plugged in or out since `open`.
  [[nodiscard]] std::uint64_t changes() const;
  /// Waits until `changes` is more than `seen`; false if that took longer than `most`.
  [[nodiscard]] bool wait_for_change(std::uint64_t seen, std::chrono::milliseconds most) const;
  /// `call` runs on the bus's own thread after each change; it must not block or call the bus.
  void on_change(std::function<void()> call);

  /// State shared by the bus and its transports.
  class Shared;

 private:
  explicit UsbBus(std::shared_ptr<Shared> shared) : shared_(std::move(shared)) {}
  std::shared_ptr<Shared> shared_;
};

}  // namespace popcut
