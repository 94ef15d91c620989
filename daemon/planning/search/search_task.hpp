// SPDX-License-Identifier: MIT
#pragma once

#include "core/progress.hpp"
#include "core/result.hpp"
#include "daemon/model/model.hpp"
#include "daemon/planning/design_files.hpp"
#include "daemon/planning/planner.hpp"
#include "daemon/planning/work.hpp"

namespace popcut::planning {

/// `perform` of Search: the best cards of a mesh, which are the same for the same task. The files
/// are `kFrontFile` and a picture of each card.
///
/// @retval Malformed, OutOfRange  the mesh cannot be read, or has no area or too many triangles; an
///                                option is none of a search
/// @retval Usage                  an option of the plan; its place is a pointer in the request
/// @retval Infeasible             no card shows the model, or none is cut in time
[[nodiscard]] Result<daemon::PlanningOutcome> search(WorkerTask& task, const FileSink& add,
                                                     const Progress& progress);

}  // namespace popcut::planning
