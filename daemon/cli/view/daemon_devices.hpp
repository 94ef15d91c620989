// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "core/result.hpp"
#include "daemon/cli/command.hpp"

namespace popcut::cli {

/// The cutters of one popcutd, and its address.
struct DaemonDevices {
  std::string address;
  std::vector<nlohmann::json> devices;  ///< as /v1/devices has them
  std::vector<nlohmann::json> jobs;     ///< the jobs on these devices
};

/// Asks the popcutd that can be reached.
///
/// @retval DeviceGone  there is none
/// @retval Refused     it denies access
[[nodiscard]] Result<DaemonDevices> daemon_devices();

/// One or more lines for each cutter: its state and why, its job, what it has cut, its area.
[[nodiscard]] std::vector<std::string> device_lines(const DaemonDevices& found);

/// Asks popcutd to enable, disable or reset a device.
[[nodiscard]] Result<void> act_on_device(const std::string& id, const std::string& action,
                                         const Globals& globals);

}  // namespace popcut::cli
