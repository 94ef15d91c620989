// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "core/result.hpp"
#include "daemon/client/address.hpp"

namespace popcut::daemon {

/// Where popcutd keeps things and is found, as whoever runs it.
struct Paths {
  std::string state;
  std::string socket;
  std::vector<std::string> configurations;  ///< the first that is there is read
};

/// As a service what systemd hands over ($STATE_DIRECTORY, $CONFIGURATION_DIRECTORY, /run); else
/// the user's own folders by the XDG rules. Root without XDG_RUNTIME_DIR has its socket in /run.
///
/// @retval Usage  there is no folder to be found for the state; it must be named
[[nodiscard]] Result<Paths> default_paths(const client::Environment& environment, bool root);

}  // namespace popcut::daemon
