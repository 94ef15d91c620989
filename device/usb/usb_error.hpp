// SPDX-License-Identifier: MIT
#pragma once

#include "core/result.hpp"
#include "device/usb/usb_device.hpp"

namespace popcut {

/// What a code of libusb means for the person in front of the cutter, and what to do.
///
/// @param doing  what could not be done: "the cutter cannot be <doing>"
[[nodiscard]] Error usb_error(int code, const UsbDevice& device, const char* doing);

/// Whether a device could be taken over now, with the error that taking it over would give.
[[nodiscard]] Result<void> may_be_used(const UsbDevice& device);

}  // namespace popcut
