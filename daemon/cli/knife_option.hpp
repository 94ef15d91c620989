// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "core/plan/plan.hpp"
#include "core/result.hpp"
#include "protocol/encode.hpp"

namespace CLI {
class App;
}

namespace popcut::cli {

/// What the options about the knife were given as.
struct KnifeOption {
  std::string folds, direction{"any"}, overcut, snap;
};

/// Adds --folds, --overcut, --direction and --snap.
void add_knife_options(CLI::App& command, KnifeOption& option);

/// Puts what they say into `options`.
///
/// @retval Usage  a word or a number is none of those that are lawful
[[nodiscard]] Result<void> read_knife_option(const KnifeOption& option, PlanOptions& options);

/// What each tool holder of a sheet holds: a blade has its offset told to the firmware.
[[nodiscard]] std::vector<ToolKind> holders_for(const PlannedSheet& sheet);

}  // namespace popcut::cli
