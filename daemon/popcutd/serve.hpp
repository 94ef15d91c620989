// SPDX-License-Identifier: MIT
#pragma once

#include <memory>

#include "daemon/config/config.hpp"
#include "daemon/popcutd/options.hpp"
#include "daemon/popcutd/service_manager.hpp"

namespace spdlog {
class logger;
}

namespace popcut::daemon {

/// Opens the state, starts the parts and serves until SIGINT or SIGTERM; then cuts end with their
/// stroke, tool up, and their jobs are interrupted by `shutdown`. SIGHUP reads the configuration
/// again and takes what can change while it runs.
///
/// @return the exit code: 0; 5 something is in use; 7 the state cannot be written; 78 the database
///         needs a person
[[nodiscard]] int serve(const Config& config, const DaemonOptions& options,
                        const ServiceManager& manager, const std::shared_ptr<spdlog::logger>& log);

}  // namespace popcut::daemon
