// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

namespace popcut {

/// A port of the kernel that a cutter may be connected to. It does not say which cutter.
struct PortInfo {
  std::string id;      ///< "serial:/dev/ttyUSB0", "lp:/dev/usb/lp0"
  std::string path;    ///< "/dev/ttyUSB0"
  bool usable{false};  ///< this user may open it
};

/// USB serial adapters, serial USB devices and USB printer ports, by name. Opens none of them.
[[nodiscard]] std::vector<PortInfo> list_ports();

/// Programs that have one of `paths` open, as "cupsd (812)". Only root sees other users' programs.
[[nodiscard]] std::vector<std::string> who_has_open(const std::vector<std::string>& paths);

}  // namespace popcut
