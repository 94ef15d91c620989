// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/result.hpp"
#include "daemon/config/config.hpp"

namespace popcut::daemon {

/// popcutd's command line.
struct DaemonOptions {
  std::string config{}, state{}, socket{};
  std::vector<std::string> listen{};
  std::vector<std::string> simulated{};  ///< machines, each attached as sim:NAME
  bool check_config{false};
  std::optional<int> exit{};  ///< everything was printed (--help, --version): exit with this code
};

/// @retval Usage  the command line is wrong
[[nodiscard]] Result<DaemonOptions> parse_options(int argc, const char* const* argv);

/// The configuration that runs: the file that is named, else the first default one that is there,
/// else none; over it the options; and what is still empty by who runs it.
///
/// @param found  the file that was read, empty if none
/// @retval Malformed, OutOfRange  the file; the place begins with its name
/// @retval Usage                  an option, which is the place
[[nodiscard]] Result<Config> load_config(const DaemonOptions& options, std::string& found);

}  // namespace popcut::daemon
