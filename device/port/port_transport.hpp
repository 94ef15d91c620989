// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "core/result.hpp"
#include "device/port/transport.hpp"

namespace popcut {

/// How the receiver stops the sender when its buffer is full.
enum class FlowControl : std::uint8_t {
  None,     ///< not at all: data sent too fast is lost
  RtsCts,   ///< by wires of the cable
  XonXoff,  ///< by the bytes 0x11 and 0x13
};

/// Settings of a serial port, besides 8 bits, no parity, one stop bit.
struct SerialSettings {
  std::uint32_t baud{9600};
  FlowControl flow{FlowControl::None};
};

/// A serial port of the kernel (also USB adapters and CDC-ACM devices) or a printer port
/// (`/dev/usb/lp0`). On the steady clock.
///
/// It hands few bytes at a time to the kernel, and no more until those are sent. So `in_transit`
/// stays small: bytes that the kernel will send and that must not be sent again, but that the
/// cutter does not have yet. Errors of `write` and `read`:
/// - Timeout     the deadline passed
/// - DeviceGone  the port hung up or failed: cable or adapter unplugged
class PortTransport final : public Transport {
 public:
  /// Opens a serial port exclusively.
  ///
  /// @retval DeviceGone  there is no such port, or nothing is connected to it
  /// @retval Refused     no permission; used by another program; unsupported speed; not a serial
  /// port
  [[nodiscard]] static Result<std::unique_ptr<PortTransport>> open_serial(
      const std::string& path, const SerialSettings& settings);
  /// Opens a printer port exclusively. Errors as above.
  [[nodiscard]] static Result<std::unique_ptr<PortTransport>> open_printer(const std::string& path);

  PortTransport(const PortTransport&) = delete;
  PortTransport& operator=(const PortTransport&) = delete;
  /// Waits up to five seconds for bytes in transit: closing a port drops them.
  ~PortTransport() override;

  [[nodiscard]] WriteEnd write(std::span<const std::byte> bytes, Deadline until) override;
  [[nodiscard]] Result<std::vector<std::byte>> read(Deadline until) override;
  [[nodiscard]] std::chrono::nanoseconds now() const override;
  void wait(std::chrono::nanoseconds duration) override;
  [[nodiscard]] std::size_t in_transit() const override;

  /// The port itself, different for serial and printer.
  class Port;

 private:
  explicit PortTransport(std::unique_ptr<Port> port);
  /// Waits until the kernel has sent what it was handed; false at the deadline.
  bool settle(Deadline until);
  [[nodiscard]] Error gone() const;

  std::unique_ptr<Port> port_;
  std::size_t handed_over_{};  ///< bytes of the last write to the kernel, maybe not sent yet
};

}  // namespace popcut
