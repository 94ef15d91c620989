// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/machines/machine.hpp"

struct libusb_device;

namespace popcut {

/// The interface of a device that receives a cutter's program, read from the descriptors: models
/// differ in their endpoints.
struct UsbInterface {
  std::uint8_t number{};
  std::uint8_t alternate{};
  std::uint8_t out_endpoint{};  ///< bulk OUT
  std::uint8_t in_endpoint{};   ///< bulk IN; 0: none, the device cannot answer
  std::uint16_t max_packet_bytes{64};
  bool printer{false};  ///< class 7; else vendor specific
};

/// A connected device that accepts bytes as a printer or cutter does. All of this comes from the
/// descriptors and from sysfs; nothing was sent to the device.
struct UsbDevice {
  std::string id;    ///< "usb:SERIAL", or "usb:1-2.3" (its port) if its serial is not unique
  std::string port;  ///< "1-2.3": bus 1, port 2 of it, port 3 of the hub there
  std::string node;  ///< "/dev/bus/usb/001/004"
  std::string serial, manufacturer, product;  ///< printable, as the device names them; may be empty
  std::uint16_t vendor_id{}, product_id{};
  UsbInterface interface;
};

/// Whether popcut may use a device now.
enum class UsbState : std::uint8_t {
  Free,          ///< yes; a kernel driver that uses it gets detached
  Busy,          ///< another program has claimed it
  NoPermission,  ///< this user may not open its node for reading and writing
  Absent,        ///< it was unplugged
};
/// "free", "busy", "no permission", "absent".
[[nodiscard]] std::string_view name_of(UsbState state);

/// Who uses a device.
struct UsbUse {
  UsbState state{};
  std::string driver;  ///< kernel driver bound to the interface: "usblp", "usbfs" for a program
};

/// Opens the node briefly and asks the kernel who uses the interface. Sends nothing.
[[nodiscard]] UsbUse usb_use(const UsbDevice& device);

/// Reads descriptors and sysfs. `node` is empty if no interface accepts bulk data as a printer
/// does: the device is not a cutter.
[[nodiscard]] UsbDevice describe(libusb_device* device);

/// Gives each device its id: its serial or, if that is empty, has unusual characters or is not
/// unique, its port.
void name_devices(std::vector<UsbDevice>& devices);

/// The machines with the device's USB ids; several if a user's table has more rows for the same
/// model.
[[nodiscard]] std::vector<const Machine*> recognise(const UsbDevice& device,
                                                    const std::vector<Machine>& machines);

/// True if `machines` has any of the device's vendor: then it is a cutter, maybe of a new model.
[[nodiscard]] bool known_vendor(const UsbDevice& device, const std::vector<Machine>& machines);

}  // namespace popcut
