// SPDX-License-Identifier: MIT
#pragma once

#include "core/result.hpp"
#include "device/usb/usb_device.hpp"

namespace popcut {

/// An error for a code of libusb that says what to do.
///
/// @param doing  what failed, as in "the cutter cannot be <doing>"
[[nodiscard]] Error usb_error(int code, const UsbDevice& device, const char* doing);

/// Checks whether a device can be connected to now; the error is that of connecting.
[[nodiscard]] Result<void> may_be_used(const UsbDevice& device);

}  // namespace popcut
