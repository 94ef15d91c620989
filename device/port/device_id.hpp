// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "core/result.hpp"
#include "device/port/serial_transport.hpp"

namespace popcut {

enum class DeviceKind : std::uint8_t {
  Simulated,  ///< "sim:cameo3"
  Usb,        ///< "usb:51053P", "usb:1-2.3"
  Serial,     ///< "serial:/dev/ttyUSB0,baud=38400,flow=rtscts"
  Printer,    ///< "lp:/dev/usb/lp0"
  File,       ///< "file:sheet.gpgl"
};

/// What --device means.
struct DeviceId {
  DeviceKind kind{};
  std::string text;  ///< as it was given
  std::string name;  ///< machine, path, or for USB the whole id
  SerialSettings serial;
};

/// Reads a device id. A serial port is followed by what differs from 9600 baud without flow
/// control: `,baud=N` and `,flow=none|rtscts|xonxoff`.
///
/// @retval Usage  it is none; the place is "--device"
[[nodiscard]] Result<DeviceId> parse_device_id(std::string_view text);

}  // namespace popcut
