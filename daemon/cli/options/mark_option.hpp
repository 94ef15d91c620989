// SPDX-License-Identifier: MIT
#pragma once

#include "daemon/planning/plan_words.hpp"

namespace CLI {
class App;
}

namespace popcut::cli {

using planning::MarkWords;

/// Adds --marks and --mark-form.
void add_mark_options(CLI::App& command, MarkWords& option);

}  // namespace popcut::cli
