// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "daemon/config/config.hpp"

namespace popcut::daemon {

/// What a person at the terminal is told once popcutd serves: where, with what, and what to type
/// next.
[[nodiscard]] std::string greeting(const Config& config, const std::vector<std::string>& endpoints);

}  // namespace popcut::daemon
