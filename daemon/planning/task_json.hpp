// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>

#include "core/result.hpp"
#include "daemon/planning/planner.hpp"
#include "daemon/planning/work.hpp"

namespace popcut::planning {

/// The words of a task as they go through the pipe; its bytes go in frames of their own.
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
/// The error that a worker tells; one of its own if that cannot be read.
[[nodiscard]] Error read_error(std::string_view json);

}  // namespace popcut::planning
