// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "core/result.hpp"
#include "device/port/transport.hpp"

namespace popcut {

/// Who says stop when a buffer is full.
enum class FlowControl : std::uint8_t {
  None,     ///< nobody: only what is sent slowly enough arrives
  RtsCts,   ///< wires of the cable
  XonXoff,  ///< bytes 0x11 and 0x13
};

/// How a serial port is spoken to: 8 bits, no parity, one stop bit.
struct SerialSettings {
  std::uint32_t baud{9600};
  FlowControl flow{FlowControl::None};
};

/// A port of the kernel that takes bytes: a serial one (also USB adapters and CDC-ACM devices), or
/// a printer's (`/dev/usb/lp0`). On the steady clock.
///
/// Few bytes at a time are handed to the kernel, and no more until those are on their way, so that
/// `in_transit` stays small: what the kernel took will be sent, must not be sent again, but is not
/// at the cutter yet. Errors of `write` and `read`:
/// - Timeout     the deadline passed
/// - DeviceGone  the port hung up or failed: cable or adapter unplugged
class PortTransport final : public Transport {
 public:
  /// Opens a serial port for popcut alone.
  ///
  /// @retval DeviceGone  no such port, or nothing behind it
  /// @retval Refused     no permission; another program has it; no such speed; no serial port
  [[nodiscard]] static Result<std::unique_ptr<PortTransport>> open_serial(
      const std::string& path, const SerialSettings& settings);
  /// Opens a printer port for popcut alone. Errors as above.
  [[nodiscard]] static Result<std::unique_ptr<PortTransport>> open_printer(const std::string& path);

  PortTransport(const PortTransport&) = delete;
  PortTransport& operator=(const PortTransport&) = delete;
  /// Waits up to five seconds for what is still on its way: ports drop it when they are closed.
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
  /// Waits until what was handed over is on its way; false at the deadline.
  bool settle(Deadline until);
  [[nodiscard]] Error gone() const;

  std::unique_ptr<Port> port_;
  std::size_t handed_over_{};  ///< by the last write to the kernel, maybe still there
};

}  // namespace popcut
