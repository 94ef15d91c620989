// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "core/progress.hpp"
#include "core/result.hpp"
#include "daemon/planning/planner.hpp"
#include "daemon/planning/work.hpp"

namespace popcut::planning {

/// A task as JSON for the pipe; its bytes go in separate frames.
[[nodiscard]] std::string task_json(const WorkerTask& task);
/// @retval Malformed, OutOfRange  it is not of that form
[[nodiscard]] Result<WorkerTask> read_task(std::string_view json);

/// The figures of an outcome, without its files.
[[nodiscard]] std::string outcome_json(const daemon::PlanningOutcome& outcome);
/// Figures from a worker, which is not trusted.
///
/// @retval Malformed, OutOfRange  they are not of that form
[[nodiscard]] Result<daemon::PlanningOutcome> read_outcome(std::string_view json);

[[nodiscard]] std::string error_json(const Error& error);
/// The error a worker reports, or an Internal error if it cannot be read.
[[nodiscard]] Error read_error(std::string_view json);

/// The phase of planning that `doing`, told by what takes long, belongs to: "reading", "slicing",
/// "lattice", "checking", "cleaning", "splitting", "toolpath", "writing"; "searching" for what a
/// search of cards does; "planning" for others.
[[nodiscard]] std::string_view phase_of(std::string_view doing);

/// What a worker writes of it (see `Progress`), and what popcutd reads of that: at most 100
/// printable characters, a part from 0 to 1. Nothing if it is not what a worker writes.
[[nodiscard]] std::string phase_json(std::string_view doing, double done);
[[nodiscard]] std::optional<daemon::PlanningPhase> read_phase(std::string_view json);

}  // namespace popcut::planning
