// SPDX-License-Identifier: MIT
#include "daemon/popcutd/greeting.hpp"

#include <fmt/format.h>

namespace popcut::daemon {
namespace {

std::string device_text(const DeviceConfig& device) {
  if (!device.enabled) return device.id + " (disabled)";
  if (device.id.rfind("sim:", 0) != 0) return device.id;
  return device.time_scale > 0
             ? fmt::format("{} ({:g} times as fast as the machine)", device.id, device.time_scale)
             : device.id + " (at once)";
}

}  // namespace

std::string greeting(const Config& config, const std::vector<std::string>& endpoints) {
  std::string text = fmt::format("popcutd {} is ready at", POPCUT_VERSION);
  for (const std::string& one : endpoints) {
    const bool path = one.rfind("unix:", 0) == 0;
    text += path ? "\n  " + one.substr(5) : "\n  http://" + one;
  }
  text += "\nCutters";
  for (const DeviceConfig& device : config.devices) text += "\n  " + device_text(device);
  text += fmt::format("\nJobs are stored in {}\n", config.state);
  text +=
      "\nNext, in another terminal:\n  popcut cut sphere.json --wait     # queue it; it tells you "
      "when to act\n  popcut arm; popcut start          # after you have loaded the sheet: cut "
      "it\n  popcut jobs --watch               # follow all jobs\nPress Ctrl-C to stop popcutd; a "
      "running cut stops at the end of its stroke.\n\n";
  return text;
}

}  // namespace popcut::daemon
