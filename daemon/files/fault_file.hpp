// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "core/result.hpp"
#include "device/sim/sim_faults.hpp"

namespace popcut::cli {

/// Reads a fault script; its errors name the file.
[[nodiscard]] Result<std::vector<SimFault>> read_faults(const std::string& file);

}  // namespace popcut::cli
