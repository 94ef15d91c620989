// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "core/result.hpp"
#include "device/port/port_transport.hpp"

namespace popcut {

enum class DeviceKind : std::uint8_t {
  Simulated,  ///< "sim:cameo3"
  Usb,        ///< "usb:51053P", "usb:1-2.3"
  Serial,     ///< "serial:/dev/ttyUSB0,baud=38400,flow=rtscts"
  Printer,    ///< "lp:/dev/usb/lp0"
  File,       ///< "file:sheet.gpgl"
};

/// The value of --device, parsed.
struct DeviceId {
  DeviceKind kind{};
  std::string text;  ///< as given
  std::string name;  ///< machine, path, or for USB the whole id
  SerialSettings serial;
};

/// Parses a device id. A serial port may be followed by `,baud=N` (default 9600) and
/// `,flow=none|rtscts|xonxoff` (default none).
///
/// @retval Usage  it is not a device id; the place is "--device"
[[nodiscard]] Result<DeviceId> parse_device_id(std::string_view text);

}  // namespace popcut
