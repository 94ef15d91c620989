// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "core/result.hpp"
#include "daemon/cli/command.hpp"

namespace popcut::cli {

struct PtyOptions {
  std::string machine;  ///< empty: cameo3
  std::string folder;   ///< empty: what the knife did is not kept
  std::string faults;   ///< a fault script; empty: none
  double speedup{1};
};

/// `popcut simulate --pty`: a simulated cutter at a pseudo terminal until Ctrl-C, with the panel's
/// buttons as keys, and cut.svg and trace.json in the folder at the end.
[[nodiscard]] Result<void> serve_pty(const PtyOptions& options, const Globals& globals);

}  // namespace popcut::cli
