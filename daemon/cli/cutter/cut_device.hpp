// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "core/machines/machine.hpp"
#include "core/result.hpp"
#include "device/port/device_id.hpp"
#include "device/sim/sim_faults.hpp"

namespace popcut::cli {

/// Where a job is cut, and as what machine.
struct CutTarget {
  DeviceId device;
  Machine machine;
  std::vector<SimFault> faults{};  ///< of the simulated cutter

  [[nodiscard]] bool simulated() const { return device.kind == DeviceKind::Simulated; }
  /// Something with a knife: a person says yes first.
  [[nodiscard]] bool real() const { return !simulated() && device.kind != DeviceKind::File; }
};

/// The words of the command line that say where.
struct CutTargetOptions {
  std::string device;    ///< empty: the simulated machine
  std::string machine;   ///< --machine
  std::string treat_as;  ///< --treat-as: a model that is not known is driven as this one
};

/// Finds the device and what machine it is: a USB device by its ids, a simulated one by its name,
/// a port by --machine or --treat-as. Sends nothing, claims nothing.
///
/// @retval Usage       the words contradict each other or are not known
/// @retval DeviceGone  the device is not there
/// @retval Refused     it may not be used now, or its model is not known
[[nodiscard]] Result<CutTarget> choose_target(const CutTargetOptions& options);

/// Where the sheet of a job goes if the device is a file: one sheet has its name, several have
/// numbers ("out-02.gpgl").
[[nodiscard]] std::string sheet_path(const CutTarget& target, std::size_t sheet,
                                     std::size_t sheets);

}  // namespace popcut::cli
