// SPDX-License-Identifier: MIT
#pragma once

#include <map>
#include <string>

#include "core/design/target/surface_spec.hpp"
#include "core/progress.hpp"
#include "core/result.hpp"
#include "daemon/planning/design_files.hpp"
#include "daemon/planning/planner.hpp"

namespace popcut::planning {

/// A task with its bytes.
struct WorkerTask {
  daemon::PlanningTask::Kind kind{};
  std::string design_kind{};  ///< empty: by the content
  std::string machine_json{}, material_json{}, profile_json{};
  std::map<std::string, std::string> options{};
  std::string design{};
  SurfaceAssets assets{};  ///< by id
};

/// Does a task: the same code as `popcut plan` and `popcut design`, on values alone. The files go
/// to `add` as they are made; `files` of the outcome stays empty. The same task gives the same
/// bytes. While a plan is made, `progress` is told what is being done.
///
/// @retval Malformed, OutOfRange  the design, at a JSON pointer or a line and column; an option, at
///                                "/options/NAME"; a file of a spec that is no asset's id
/// @retval Infeasible             there is no valid pattern or layout for it
[[nodiscard]] Result<daemon::PlanningOutcome> perform(WorkerTask task, const FileSink& add,
                                                      const Progress& progress = {});

/// `perform` of what somebody looks at (Preview, Lattice, Picture, Export, Place).
[[nodiscard]] Result<daemon::PlanningOutcome> show(WorkerTask& task, const FileSink& add);

}  // namespace popcut::planning
