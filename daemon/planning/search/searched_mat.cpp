// SPDX-License-Identifier: MIT
#include "daemon/planning/search/searched_mat.hpp"

#include <fmt/format.h>

#include "core/plan/marks.hpp"
#include "daemon/planning/plan_job.hpp"

namespace popcut::planning {

Result<SearchedMat> searched_mat(const PlanOptions& options,
                                 const std::vector<std::string>& tables) {
  const auto job = make_plan_job(
      options, tables, [](const SvgReadOptions&) { return test_shape_input(); }, "");
  if (!job) {
    Error error = job.error();
    // Those who write programs know no options.
    if (options.marks && (error.place == "/language" || error.place == "marks"))
      error.place = "/options/marks";
    // What is wrong with no option is wrong with the test shape: it is the smallest that popcut
    // has.
    if (error.place.empty() || error.kind == ErrorKind::Infeasible)
      error = {ErrorKind::Infeasible, "/options/mat",
               fmt::format("has no room for a card{}; use a larger one",
                           options.marks ? " between registration marks" : "")};
    return tl::unexpected(std::move(error));
  }
  SearchedMat mat;
  mat.machine = job->plan.machine;
  if (!mat.machine.driven())
    return fail(ErrorKind::Usage, "/machine",
                fmt::format("popcut knows no cutting times of {}, by which cards are chosen; "
                            "choose a `machine` that popcut drives",
                            mat.machine.title));
  mat.area_mm = job->plan.sheets.front().area_mm;
  mat.room_mm = options.marks ? room_within_marks_mm(mat.area_mm) : mat.area_mm;
  return mat;
}

}  // namespace popcut::planning
