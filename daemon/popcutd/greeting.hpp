// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "daemon/config/config.hpp"

namespace popcut::daemon {

/// What popcutd prints at a terminal when it is ready: addresses, cutters, and what to type
/// next.
[[nodiscard]] std::string greeting(const Config& config, const std::vector<std::string>& endpoints);

}  // namespace popcut::daemon
