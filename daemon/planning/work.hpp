// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <map>
#include <string>

#include "core/design/patches.hpp"
#include "core/design/target/surface_spec.hpp"
#include "core/progress.hpp"
#include "core/result.hpp"
#include "daemon/planning/design_files.hpp"
#include "daemon/planning/plan_input.hpp"
#include "daemon/planning/plan_job.hpp"
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

/// Does a task, but no search (see planning/search/search_task): the same code as `popcut plan` and
/// `popcut design`, on values alone. The files go to `add` as they are made; `files` of the outcome
/// stays empty. The same task gives the same bytes. `progress` hears what is done for a plan.
///
/// @retval Malformed, OutOfRange  the design, at a JSON pointer or a line and column; an option, at
///                                "/options/NAME"; a file of a spec that is no asset's id
/// @retval Infeasible             there is no valid pattern or layout for it
[[nodiscard]] Result<daemon::PlanningOutcome> perform(WorkerTask task, const FileSink& add,
                                                      const Progress& progress = {});

/// `perform` of what somebody looks at (Preview, Lattice, Picture, Export, Place).
[[nodiscard]] Result<daemon::PlanningOutcome> show(WorkerTask& task, const FileSink& add);

/// The plan of a task; the same task gives the same.
///
/// @param outcome  receives what kind of design it is
/// @param sources  who receives the design of a spec; all else of it comes from the task
/// @param by_hand  the machine may be one that popcut does not drive, or none: an ideal plotter
[[nodiscard]] Result<PlanJob> planned(WorkerTask& task, daemon::PlanningOutcome& outcome,
                                      SpecSources sources, const Progress& progress,
                                      bool by_hand = false);

/// What the options of a task begin with that are not those of its plan: "way", a row of
/// `make_ways`, or "drawing" for `drawing_question` alone.
inline constexpr const char* kMakeOption = "make-";
inline constexpr const char* kMakeFile = "make.json";
/// `perform` of the sheets for a way of making, as one JSON document. If the drawing has to be
/// explained first, the document is `{"asks": ...}` with what `drawing_question` says.
[[nodiscard]] Result<daemon::PlanningOutcome> make_sheets(WorkerTask& task, const FileSink& add,
                                                          const Progress& progress);

/// What the options of a task begin with that are not those of its plan.
inline constexpr const char* kArtworkOption = "artwork-";
inline constexpr const char* kArtworkFile = "artwork.pdf";
/// `perform` of the artwork of a sheet. The plan is made again, and has to give the program that it
/// gave before: so its cuts match.
[[nodiscard]] Result<daemon::PlanningOutcome> draw_artwork(WorkerTask& task, const FileSink& add,
                                                           const Progress& progress);

}  // namespace popcut::planning
