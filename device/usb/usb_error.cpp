// SPDX-License-Identifier: MIT
#include "device/usb/usb_error.hpp"

#include <fmt/format.h>
#include <libusb-1.0/libusb.h>

namespace popcut {

Error usb_error(int code, const UsbDevice& device, const char* doing) {
  switch (code) {
    case LIBUSB_ERROR_NO_DEVICE:
    case LIBUSB_ERROR_NOT_FOUND:
      return {ErrorKind::DeviceGone, device.id,
              "the cutter was unplugged or switched off; check cable and power"};
    case LIBUSB_ERROR_ACCESS:
      return {ErrorKind::Refused, device.id,
              fmt::format("no permission to use {}; install popcut's udev rule and join the group "
                          "popcut-usb ('popcut doctor' shows how)",
                          device.node)};
    case LIBUSB_ERROR_BUSY:
      return {
          ErrorKind::Refused, device.id,
          "another program uses the cutter; stop that program first ('popcut doctor' names it)"};
    case LIBUSB_ERROR_NO_MEM:
      return {
          ErrorKind::Refused, device.id,
          "the kernel has no memory left for USB transfers; raise "
          "/sys/module/usbcore/parameters/usbfs_memory_mb, or stop other programs that use USB"};
    default:
      return {ErrorKind::Refused, device.id,
              fmt::format("the cutter cannot be {} (libusb: {}); plug it in again, at another port "
                          "if that does not help",
                          doing, libusb_strerror(code))};
  }
}

Result<void> may_be_used(const UsbDevice& device) {
  switch (usb_use(device).state) {
    case UsbState::Busy:
      return tl::unexpected(usb_error(LIBUSB_ERROR_BUSY, device, "used"));
    case UsbState::NoPermission:
      return tl::unexpected(usb_error(LIBUSB_ERROR_ACCESS, device, "used"));
    case UsbState::Absent:
      return tl::unexpected(usb_error(LIBUSB_ERROR_NO_DEVICE, device, "used"));
    case UsbState::Free:
      break;
  }
  return {};
}

}  // namespace popcut
