// SPDX-License-Identifier: MIT
#include "tests/support/usbfs_shape.hpp"

#include <fmt/format.h>

namespace popcut::testing {

std::string UsbfsShape::node() const {
  return fmt::format("/dev/bus/usb/{:03}/{:03}", bus, address);
}

std::string UsbfsShape::sysfs_path() const {
  return fmt::format("/devices/usb{0}/{0}-{1}", bus, port);
}

std::vector<std::uint8_t> UsbfsShape::descriptors() const {
  const auto low = [](unsigned v) { return static_cast<std::uint8_t>(v & 0xff); };
  const auto high = [](unsigned v) { return static_cast<std::uint8_t>(v >> 8); };
  // As a Cameo 3 sends them: USB 2.0, 64-byte packets, self-powered, 100 mA.
  std::vector<std::uint8_t> bytes{18, 1, 0, 2, 0, 0, 0, 64};
  bytes.insert(bytes.end(), {low(vendor), high(vendor), low(product), high(product)});
  bytes.insert(bytes.end(), {0, 1, 1, 2, 3, 1});
  std::vector<std::uint8_t> config{9, 2, 0, 0, 1, 1, 0, 0xc0, 50};
  const auto endpoint = [&](std::uint8_t at, std::uint8_t type, std::uint8_t packet) {
    config.insert(config.end(), {7, 5, at, type, packet, 0, 1});
  };
  const auto endpoints =
      static_cast<std::uint8_t>(1 + (in_endpoint != 0 ? 1 : 0) + (interrupt_endpoint ? 1 : 0));
  config.insert(config.end(), {9, 4, 0, 0, endpoints, interface_class, 1, interface_protocol, 0});
  if (interrupt_endpoint) endpoint(0x83, 3, 32);
  endpoint(out_endpoint, 2, 64);
  if (in_endpoint != 0) endpoint(in_endpoint, 2, 64);
  config[2] = low(static_cast<unsigned>(config.size()));
  bytes.insert(bytes.end(), config.begin(), config.end());
  return bytes;
}

std::string UsbfsShape::sysfs_entry() const {
  std::string hex;
  for (const std::uint8_t byte : descriptors()) hex += fmt::format("{:02x}", byte);
  return fmt::format(
      "P: {0}\nE: SUBSYSTEM=usb\nE: DEVTYPE=usb_device\nE: DRIVER=usb\nE: DEVNAME={1}\n"
      "E: PRODUCT={2:x}/{3:x}/100\nE: BUSNUM={4:03}\nE: DEVNUM={5:03}\nE: MAJOR=189\nE: MINOR={6}\n"
      "A: busnum={4}\\n\nA: devnum={5}\\n\nA: bConfigurationValue=1\\n\nA: speed=12\\n\n"
      "A: idVendor={2:04x}\\n\nA: idProduct={3:04x}\\n\nA: serial={7}\\n\nA: manufacturer={8}\\n\n"
      "A: product={9}\\n\nA: devpath={10}\\n\nH: descriptors={11}\n",
      sysfs_path(), node(), vendor, product, bus, address, (bus - 1) * 128 + address - 1, serial,
      manufacturer, name, port, hex);
}

}  // namespace popcut::testing
