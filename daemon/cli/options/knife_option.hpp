// SPDX-License-Identifier: MIT
#pragma once

#include "daemon/planning/plan_words.hpp"

namespace CLI {
class App;
}

namespace popcut::cli {

using planning::KnifeWords;

/// Adds --folds, --overcut, --direction and --snap.
void add_knife_options(CLI::App& command, KnifeWords& option);

}  // namespace popcut::cli
