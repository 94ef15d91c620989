// SPDX-License-Identifier: MIT
#pragma once

#include "daemon/planning/plan_words.hpp"

namespace CLI {
class App;
}

namespace popcut::cli {

using planning::SplitWords;

/// Adds --seam-x, --seam-y, --labels and --no-split.
void add_split_options(CLI::App& command, SplitWords& option);

}  // namespace popcut::cli
