// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <string>

#include "daemon/planning/planner.hpp"

namespace popcut::daemon {

/// A planner whose tasks run in processes of `program`, which must do `planning::run_worker(0, 1)`
/// when its first argument is `--worker` (/proc/self/exe for popcutd itself). Tasks start
/// in the order they came. Its destructor kills running tasks and reports them as Refused.
[[nodiscard]] std::unique_ptr<Planner> make_planner(const PlanningLimits& limits,
                                                    std::string program);

}  // namespace popcut::daemon
