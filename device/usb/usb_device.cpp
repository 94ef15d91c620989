// SPDX-License-Identifier: MIT
#include "device/usb/usb_device.hpp"

#include <fcntl.h>
#include <linux/usbdevice_fs.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <optional>
#include <span>

#include <fmt/format.h>
#include <libusb-1.0/libusb.h>

namespace popcut {
namespace {

constexpr std::uint8_t kIppOverUsb = 4;  // a protocol of the printer class that accepts only HTTP

std::string port_of(libusb_device* device) {
  std::array<std::uint8_t, 7> ports{};  // USB 3.0 has at most 7 tiers
  const int depth = libusb_get_port_numbers(device, ports.data(), ports.size());
  std::string path = fmt::format("{}", libusb_get_bus_number(device));
  for (int i = 0; i < depth; ++i)
    path += fmt::format("{}{}", i == 0 ? '-' : '.', ports[static_cast<std::size_t>(i)]);
  return path;
}

/// One line of sysfs in printable ASCII.
std::string sysfs_text(const std::string& port, const char* attribute) {
  constexpr std::size_t kLongest = 126;  // a string descriptor holds no more characters
  const std::string path = fmt::format("/sys/bus/usb/devices/{}/{}", port, attribute);
  std::FILE* const file = std::fopen(path.c_str(), "re");
  if (file == nullptr) return {};
  std::array<char, kLongest + 2> line{};
  const char* const got = std::fgets(line.data(), static_cast<int>(line.size()), file);
  std::fclose(file);
  std::string text = got == nullptr ? "" : got;
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return text;
}

/// The driver of an interface according to sysfs; empty if sysfs names none.
std::string sysfs_driver(const UsbDevice& device) {
  const std::string path = fmt::format("/sys/bus/usb/devices/{}:1.{}/driver", device.port,
                                       unsigned{device.interface.number});
  std::array<char, 256> target{};
  const ssize_t length = ::readlink(path.c_str(), target.data(), target.size() - 1);
  if (length <= 0) return {};
  const std::string_view whole(target.data(), static_cast<std::size_t>(length));
  return std::string(whole.substr(whole.rfind('/') + 1));
}

std::optional<UsbInterface> usable(const libusb_interface_descriptor& described) {
  const bool printer = described.bInterfaceClass == LIBUSB_CLASS_PRINTER &&
                       described.bInterfaceProtocol != kIppOverUsb;
  if (!printer && described.bInterfaceClass != LIBUSB_CLASS_VENDOR_SPEC) return std::nullopt;
  UsbInterface found;
  found.number = described.bInterfaceNumber;
  found.alternate = described.bAlternateSetting;
  found.printer = printer;
  for (const libusb_endpoint_descriptor& endpoint :
       std::span(described.endpoint, described.bNumEndpoints)) {
    if ((endpoint.bmAttributes & LIBUSB_TRANSFER_TYPE_MASK) != LIBUSB_TRANSFER_TYPE_BULK) continue;
    const bool in = (endpoint.bEndpointAddress & LIBUSB_ENDPOINT_DIR_MASK) == LIBUSB_ENDPOINT_IN;
    std::uint8_t& slot = in ? found.in_endpoint : found.out_endpoint;
    if (slot != 0) continue;
    slot = endpoint.bEndpointAddress;
    if (endpoint.wMaxPacketSize > 0)
      found.max_packet_bytes =
          std::max<std::uint16_t>(found.max_packet_bytes, endpoint.wMaxPacketSize & 0x7ff);
  }
  if (found.out_endpoint == 0) return std::nullopt;
  return found;
}

/// Best is a printer interface that answers, then one that does not, then a vendor-specific one.
int rank(const UsbInterface& interface) {
  return (interface.printer ? 2 : 0) + (interface.in_endpoint != 0 ? 1 : 0);
}

std::optional<UsbInterface> best_interface(const libusb_config_descriptor& config) {
  std::optional<UsbInterface> best;
  for (const libusb_interface& interface : std::span(config.interface, config.bNumInterfaces))
    for (const libusb_interface_descriptor& alternate :
         std::span(interface.altsetting, static_cast<std::size_t>(interface.num_altsetting))) {
      const std::optional<UsbInterface> found = usable(alternate);
      if (found && (!best || rank(*found) > rank(*best))) best = found;
    }
  return best;
}

/// Usable as an id: letters, digits and few signs, and not like the name of a port.
bool usable_serial(const std::string& serial) {
  const auto plain = [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '_' ||
           c == '.' || c == '-';
  };
  const auto of_port = [](char c) { return (c >= '0' && c <= '9') || c == '.' || c == '-'; };
  const bool like_port =
      serial.find('-') != std::string::npos && std::all_of(serial.begin(), serial.end(), of_port);
  return !serial.empty() && !like_port && std::all_of(serial.begin(), serial.end(), plain);
}

}  // namespace

std::string_view name_of(UsbState state) {
  constexpr std::array<std::string_view, 4> kNames{"free", "busy", "no permission", "absent"};
  return kNames.at(static_cast<std::size_t>(state));
}

UsbDevice describe(libusb_device* device) {
  UsbDevice found;
  libusb_device_descriptor descriptor{};
  if (libusb_get_device_descriptor(device, &descriptor) != 0) return found;
  libusb_config_descriptor* config = nullptr;
  if (libusb_get_active_config_descriptor(device, &config) != 0 &&
      libusb_get_config_descriptor(device, 0, &config) != 0)
    return found;
  const std::optional<UsbInterface> interface = best_interface(*config);
  libusb_free_config_descriptor(config);
  if (!interface) return found;
  found.interface = *interface;
  found.vendor_id = descriptor.idVendor;
  found.product_id = descriptor.idProduct;
  found.port = port_of(device);
  found.node = fmt::format("/dev/bus/usb/{:03}/{:03}", libusb_get_bus_number(device),
                           libusb_get_device_address(device));
  found.serial = sysfs_text(found.port, "serial");
  found.manufacturer = sysfs_text(found.port, "manufacturer");
  found.product = sysfs_text(found.port, "product");
  return found;
}

void name_devices(std::vector<UsbDevice>& devices) {
  for (UsbDevice& device : devices) {
    const auto same = std::count_if(devices.begin(), devices.end(), [&](const UsbDevice& other) {
      return other.serial == device.serial;
    });
    const bool by_serial = same == 1 && usable_serial(device.serial);
    device.id = "usb:" + (by_serial ? device.serial : device.port);
  }
}

UsbUse usb_use(const UsbDevice& device) {
  UsbUse use;
  const int node = ::open(device.node.c_str(), O_RDWR | O_CLOEXEC | O_NOCTTY);
  if (node < 0) {
    const bool forbidden = errno == EACCES || errno == EPERM || errno == EROFS;
    use.state = forbidden ? UsbState::NoPermission : UsbState::Absent;
    use.driver = sysfs_driver(device);
    return use;
  }
  usbdevfs_getdriver who{};
  who.interface = device.interface.number;
  if (::ioctl(node, USBDEVFS_GETDRIVER, &who) == 0)
    use.driver.assign(who.driver, ::strnlen(who.driver, sizeof who.driver));
  else if (errno == ENODEV)
    use.state = UsbState::Absent;
  ::close(node);
  if (use.driver == "usbfs") use.state = UsbState::Busy;
  return use;
}

std::vector<const Machine*> recognise(const UsbDevice& device,
                                      const std::vector<Machine>& machines) {
  std::vector<const Machine*> found;
  for (const Machine& machine : machines)
    if (machine.usb_vendor != 0 && machine.usb_vendor == device.vendor_id &&
        machine.usb_product == device.product_id)
      found.push_back(&machine);
  return found;
}

bool known_vendor(const UsbDevice& device, const std::vector<Machine>& machines) {
  return std::any_of(machines.begin(), machines.end(), [&](const Machine& machine) {
    return machine.usb_vendor != 0 && machine.usb_vendor == device.vendor_id;
  });
}

}  // namespace popcut
