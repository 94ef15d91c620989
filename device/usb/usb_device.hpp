// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/machines/machine.hpp"

struct libusb_device;

namespace popcut {

/// The interface of a device that a cutter's program goes to. All of it is read from the
/// descriptors: gadgets and models differ in their endpoints.
struct UsbInterface {
  std::uint8_t number{};
  std::uint8_t alternate{};
  std::uint8_t out_endpoint{};  ///< bulk OUT
  std::uint8_t in_endpoint{};   ///< bulk IN; 0: none, the device cannot answer
  std::uint16_t max_packet_bytes{64};
  bool printer{false};  ///< class 7; else vendor specific
};

/// A device on the bus that takes bytes as a printer or cutter does. Nothing was sent to it to
/// learn this: it comes from the descriptors and from sysfs.
struct UsbDevice {
  std::string id;    ///< "usb:SERIAL", or "usb:1-2.3" (its port) where no serial tells it apart
  std::string port;  ///< "1-2.3": bus 1, port 2 of it, port 3 of the hub there
  std::string node;  ///< "/dev/bus/usb/001/004"
  std::string serial, manufacturer, product;  ///< printable, as the device names them; may be empty
  std::uint16_t vendor_id{}, product_id{};
  UsbInterface interface;
};

/// May popcut use a device now?
enum class UsbState : std::uint8_t {
  Free,          ///< yes; a kernel driver that holds it is asked to let go
  Busy,          ///< another program has claimed it
  NoPermission,  ///< its node may not be opened for reading and writing
  Absent,        ///< it is gone
};
/// "free", "busy", "no permission", "absent".
[[nodiscard]] std::string_view name_of(UsbState state);

/// Who has a device.
struct UsbUse {
  UsbState state{};
  std::string driver;  ///< kernel driver bound to the interface: "usblp", "usbfs" for a program
};

/// Opens the node for a moment and asks the kernel who has the interface. Sends nothing.
[[nodiscard]] UsbUse usb_use(const UsbDevice& device);

/// Reads what stands in descriptors and sysfs. An empty `node`: no interface takes bulk data as a
/// printer does, so it is none of ours.
[[nodiscard]] UsbDevice describe(libusb_device* device);

/// Gives each device its id. Serials that are empty, odd, or that two devices share are no use:
/// those get the id of their port.
void name_devices(std::vector<UsbDevice>& devices);

/// The machines whose ids are those of the device. More than one where a user's table has rows of
/// its own for the same model.
[[nodiscard]] std::vector<const Machine*> recognise(const UsbDevice& device,
                                                    const std::vector<Machine>& machines);

/// True if `machines` has any of the device's vendor: a cutter then, though maybe a new model.
[[nodiscard]] bool known_vendor(const UsbDevice& device, const std::vector<Machine>& machines);

}  // namespace popcut
