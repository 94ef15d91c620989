// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace popcut::testing {

/// The descriptors and sysfs entries of an emulated USB device.
struct UsbfsShape {
  std::uint16_t vendor{0x0b4d}, product{0x112f};  ///< Cameo 3
  std::string serial{"51053P"}, manufacturer{"Silhouette"}, name{"CAMEO 3"};
  int bus{1}, port{1}, address{2};
  std::string driver{"usblp"};  ///< of the kernel, bound to interface 0; empty: none
  std::uint8_t out_endpoint{0x01}, in_endpoint{0x82};
  bool interrupt_endpoint{false};  ///< a third one, as the Portrait V1 has
  std::uint8_t interface_class{7}, interface_protocol{2};

  /// "/dev/bus/usb/001/002"
  [[nodiscard]] std::string node() const;
  /// "/devices/usb1/1-1", below /sys
  [[nodiscard]] std::string sysfs_path() const;
  /// Device and configuration descriptor as sysfs has them.
  [[nodiscard]] std::vector<std::uint8_t> descriptors() const;
  /// The device's description for umockdev, without its node, which is made by hand.
  [[nodiscard]] std::string sysfs_entry() const;
};

}  // namespace popcut::testing
