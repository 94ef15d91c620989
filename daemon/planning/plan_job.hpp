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
  std::vector<EncodedProgram> programs;  ///< one a sheet; none if popcut does not drive the machine
  std::vector<MarkLayout> marks;         ///< one a sheet, or none

  /// "sheet-01.gpgl": the file of a sheet's program.
  [[nodiscard]] std::string program_file(std::size_t sheet) const;
  [[nodiscard]] static std::string sheet_file(std::size_t sheet, const char* ending);
};

/// Reads the drawing with the given options.
using DrawingReader = std::function<Result<DrawingInput>(const SvgReadOptions&)>;

/// How a drawing is read with these options.
///
/// @retval Usage  no such profile; what is said of layers or colours is not of its form
[[nodiscard]] Result<SvgReadOptions> read_options(const PlanOptions& options,
                                                  const std::vector<std::string>& tables);

/// Plans the sheets and encodes their programs. Values in, values out: `popcut plan` adds files
/// around it, popcutd's worker a pipe.
///
/// Default machine: an ideal plotter if `mat` is a size, else a Cameo 3. Default material: the one
/// that the input asks for, else paper-220.
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

/// Words an error about a plan option for a request: a wrong option is a value out of range, not a
/// wrong command line.
[[nodiscard]] Error in_request(Error error);

}  // namespace popcut::planning
