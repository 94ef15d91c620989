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

/// The USB of this computer, with a thread of its own on which everything that the bus reports is
/// taken in: ends of transfers, devices that come and go.
///
/// All functions may be called from any thread. Transports keep the bus alive that they came from.
class UsbBus {
 public:
  /// @retval DeviceGone  there is no USB here (a container, a virtual machine without it)
  [[nodiscard]] static Result<UsbBus> open();

  /// The devices now on the bus that take bytes as a cutter does, printers among them.
  [[nodiscard]] std::vector<UsbDevice> devices() const;

  /// The device that an id means: by serial or by port.
  ///
  /// @retval DeviceGone  no such device
  /// @retval Refused     two devices have this serial
  [[nodiscard]] Result<UsbDevice> find(const std::string& id) const;

  /// Takes a device over: its kernel driver is detached (and attached again at the end), its
  /// interface claimed. Nothing is sent to it.
  ///
  /// @param id  as `find` takes it; its errors too
  /// @retval Refused  another program has it; or no permission; or the kernel says no
  [[nodiscard]] Result<std::unique_ptr<UsbTransport>> connect(const std::string& id) const;

  /// How often devices came or went since `open`.
  [[nodiscard]] std::uint64_t changes() const;
  /// Waits until `changes` is more than `seen`; false if that took longer than `most`.
  bool wait_for_change(std::uint64_t seen, std::chrono::milliseconds most) const;
  /// Called on the bus's own thread after each change; it must not block, nor call the bus.
  void on_change(std::function<void()> call);

  /// What the bus and its transports share.
  class Shared;

 private:
  explicit UsbBus(std::shared_ptr<Shared> shared) : shared_(std::move(shared)) {}
  std::shared_ptr<Shared> shared_;
};

}  // namespace popcut
