// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "core/result.hpp"
#include "daemon/cli/command.hpp"

namespace popcut::cli {

/// The cutters of a popcutd, and where it is.
struct DaemonDevices {
  std::string address;
  std::vector<nlohmann::json> devices;  ///< as /v1/devices has them
  std::vector<nlohmann::json> jobs;     ///< those whose sheets lie in them
};

/// Asks the popcutd that is reachable.
///
/// @retval DeviceGone  there is none
/// @retval Refused     there is, and it does not let us in
[[nodiscard]] Result<DaemonDevices> daemon_devices();

/// A line or more for each cutter: state and why, what it does, what it has done, its area.
[[nodiscard]] std::vector<std::string> device_lines(const DaemonDevices& found);

/// enable, disable or reset, asked of popcutd.
[[nodiscard]] Result<void> act_on_device(const std::string& id, const std::string& action,
                                         const Globals& globals);

}  // namespace popcut::cli
