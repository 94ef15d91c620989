// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>

#include "core/result.hpp"
#include "daemon/planning/plan_job.hpp"

namespace CLI {
class App;
}

namespace popcut::cli {

using planning::PlanJob;

/// The options that say how an input becomes sheets, shared by `plan` and `cut`.
struct PlanJobOptions : planning::PlanWords {
  std::string input;
  std::optional<LineWork> drawing{};  ///< in place of the input, if there is one
};

/// Adds INPUT, --machine, --material, --mat, --at, --dialect, --svg-profile, --curve-tolerance,
/// --svg-dpi, --clip and those of `add_order_options`.
void add_plan_options(CLI::App& command, PlanJobOptions& options);

/// Reads the input and the users' tables, plans, and writes the programs.
///
/// @retval Usage       a word of an option is not known, or two contradict each other
/// @retval Malformed, OutOfRange, Infeasible  see `read_drawing`, `plan` and `encode`
[[nodiscard]] Result<PlanJob> make_plan_job(const PlanJobOptions& options);

}  // namespace popcut::cli
