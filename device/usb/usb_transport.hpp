// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <string>

#include "device/port/transport.hpp"
#include "device/usb/usb_device.hpp"

namespace popcut {

class UsbLine;

/// A claimed interface of a USB device, through libusb's asynchronous calls.
///
/// It sends one transfer at a time, and one transfer always waits for input, so that no reply is
/// lost and an unplugged cable is noticed at once. It uses the steady clock. Errors:
/// - Timeout     the deadline passed. `taken` is exact: the bytes that the device acknowledged
/// before
///               the transfer was cancelled. You may send the rest.
/// - DeviceGone  unplugged, or the bus failed in the middle of a transfer. How much of that
///               transfer arrived beyond `taken` is not known (`in_doubt`). Every later call fails
///               the same way, so that nothing is sent twice.
/// - Refused     the device stalled its endpoint, which is cleared once. `taken` was acknowledged;
///               a packet after it is in doubt. Or the kernel accepts no transfers.
class UsbTransport final : public Transport {
 public:
  explicit UsbTransport(std::shared_ptr<UsbLine> line);
  UsbTransport(const UsbTransport&) = delete;
  UsbTransport& operator=(const UsbTransport&) = delete;
  ~UsbTransport() override;

  [[nodiscard]] WriteEnd write(std::span<const std::byte> bytes, Deadline until) override;
  [[nodiscard]] Result<std::vector<std::byte>> read(Deadline until) override;
  [[nodiscard]] std::chrono::nanoseconds now() const override;
  /// Ends early if the device is unplugged.
  void wait(std::chrono::nanoseconds duration) override;
  [[nodiscard]] bool answers() const override;

  [[nodiscard]] const UsbDevice& device() const;
  /// The kernel driver that was detached ("usblp"); empty if none.
  [[nodiscard]] const std::string& displaced_driver() const;

 private:
  std::shared_ptr<UsbLine> line_;
};

}  // namespace popcut
