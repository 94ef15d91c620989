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
/// One transfer at a time goes out; one is always waiting for what comes in, so that no reply is
/// lost and an unplugged cable is seen at once. The time is that of the steady clock. Errors:
/// - Timeout     the deadline passed. `taken` is exact: the kernel counted the bytes that the
///               device acknowledged before the transfer was called back. The rest may follow.
/// - DeviceGone  unplugged, or the bus failed in the middle of a transfer. How much of that
///               transfer arrived beyond `taken` is not known (`in_doubt`). Everything after it
///               fails the same way: what may have arrived is never sent again.
/// - Refused     the device stalled its endpoint, which is cleared once. `taken` was acknowledged;
///               a packet after it is in doubt. Or the kernel takes no transfers.
class UsbTransport final : public Transport {
 public:
  explicit UsbTransport(std::shared_ptr<UsbLine> line);
  UsbTransport(const UsbTransport&) = delete;
  UsbTransport& operator=(const UsbTransport&) = delete;
  ~UsbTransport() override;

  [[nodiscard]] WriteEnd write(std::span<const std::byte> bytes, Deadline until) override;
  [[nodiscard]] Result<std::vector<std::byte>> read(Deadline until) override;
  [[nodiscard]] std::chrono::nanoseconds now() const override;
  /// Ends early when the device goes away.
  void wait(std::chrono::nanoseconds duration) override;
  [[nodiscard]] bool answers() const override;

  [[nodiscard]] const UsbDevice& device() const;
  /// The kernel driver that had to let go ("usblp"); empty if none.
  [[nodiscard]] const std::string& displaced_driver() const;

 private:
  std::shared_ptr<UsbLine> line_;
};

}  // namespace popcut
