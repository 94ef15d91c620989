// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "core/plan/plan.hpp"
#include "core/result.hpp"
#include "daemon/planning/plan_input.hpp"
#include "protocol/encode.hpp"

namespace popcut::planning {

/// A plan with the program of each of its sheets.
struct PlanJob {
  Plan plan;
  std::vector<EncodedProgram> programs;
  std::vector<MarkLayout> marks;  ///< one a sheet, or none

  /// "sheet-01.gpgl": the file of a sheet's program.
  [[nodiscard]] std::string program_file(std::size_t sheet) const;
  [[nodiscard]] static std::string sheet_file(std::size_t sheet, const char* ending);
};

/// Gives the drawing once it is known how drawings are to be read.
using DrawingReader = std::function<Result<DrawingInput>(const SvgReadOptions&)>;

/// Plans, and writes the programs. Values in, values out: `popcut plan` and popcutd's worker are
/// this with files, or a pipe, around it.
///
/// Without a machine, a `mat` that is a size is an ideal plotter of that area; else it is a
/// Cameo 3. Without a material, it is the one that the input asks for, else paper-220.
///
/// @param tables      users' tables of machines, materials and profiles, as texts
/// @param input_name  stands before the places of errors in the input; may be empty
/// @retval Usage       an option's value is not known, or two contradict each other; place is
///                     `pointer_to` the option
/// @retval Malformed   a table is not of its form; place is "table N: " and a JSON pointer
/// @retval Malformed, OutOfRange, Infeasible  see `drawing_from_text`, `plan` and `encode`
[[nodiscard]] Result<PlanJob> make_plan_job(const PlanOptions& options,
                                            const std::vector<std::string>& tables,
                                            const DrawingReader& read,
                                            const std::string& input_name);

/// The same error as one about a request: its options are a value that was sent, not a command
/// line.
[[nodiscard]] Error in_request(Error error);

}  // namespace popcut::planning
