// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/result.hpp"
#include "daemon/config/config.hpp"
#include "daemon/devices/cutters.hpp"
#include "device/session/session.hpp"

namespace popcut::daemon {

/// Which cutters popcutd has.
struct CuttersOptions {
  /// Simulated cutters ("sim:cameo3", or "sim:left" with a `machine`) and ports, which do not tell
  /// what is behind them; for USB devices only what is to be done differently. None: sim:cameo3.
  std::vector<DeviceConfig> devices{};
  std::vector<std::string> tables{};  ///< users' tables of machines, as texts
  bool usb{true};                     ///< cutters on the bus, as they come and go
  SessionOptions session{};           ///< its limits and times; hooks are not used
  double stuck_s{12};                 ///< a thread that has not turned for so long is not alive
};

/// The cutters of this machine. A `faults` script strikes in the first cut after the start. `trace`
/// names a folder for what a simulated cutter gets and does: ATTEMPT.json a sheet, and
/// received.log, to which every byte is written before anything else happens.
///
/// @retval Usage, OutOfRange, Malformed  a device's id, machine or fault script is invalid
[[nodiscard]] Result<std::unique_ptr<Cutters>> make_cutters(CuttersOptions options);

}  // namespace popcut::daemon
