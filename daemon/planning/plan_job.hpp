// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "core/plan/plan.hpp"
#include "core/result.hpp"
#include "daemon/planning/plan_input.hpp"
#include "daemon/planning/plan_words.hpp"
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
/// @param tables      users' tables of machines, materials and profiles, as texts
/// @param input_name  stands before the places of errors in the input; may be empty
/// @retval Usage       a word of an option is not known, or two contradict each other; place
/// "--mat"
/// @retval Malformed   a table is not of its form; place is "table N: " and a JSON pointer
/// @retval Malformed, OutOfRange, Infeasible  see `drawing_from_text`, `plan` and `encode`
[[nodiscard]] Result<PlanJob> make_plan_job(const PlanWords& words,
                                            const std::vector<std::string>& tables,
                                            const DrawingReader& read,
                                            const std::string& input_name);

}  // namespace popcut::planning
