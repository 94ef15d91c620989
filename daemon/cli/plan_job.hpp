// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/plan/plan.hpp"
#include "core/result.hpp"
#include "daemon/cli/knife_option.hpp"
#include "daemon/cli/mark_option.hpp"
#include "daemon/cli/order_option.hpp"
#include "daemon/cli/split_option.hpp"
#include "protocol/encode.hpp"

namespace CLI {
class App;
}

namespace popcut::cli {

/// The options that say how an input becomes sheets, shared by `plan` and `cut`.
struct PlanJobOptions {
  std::string input, machine, material, mat, at, dialect;
  OrderWords order{};
  std::string svg_profile{"popcut"};
  double curve_tolerance_mm{0.02}, svg_dpi{96};
  bool clip{false};
  KnifeOption knife;
  SplitOption split;
  MarkOption marks;
  std::optional<LineWork> drawing{};  ///< in place of the input, if there is one
};

/// Adds INPUT, --machine, --material, --mat, --at, --dialect, --svg-profile, --curve-tolerance,
/// --svg-dpi, --clip and those of `add_order_options`.
void add_plan_options(CLI::App& command, PlanJobOptions& options);

/// A plan with the program of each of its sheets.
struct PlanJob {
  Plan plan;
  std::vector<EncodedProgram> programs;
  std::vector<MarkLayout> marks;  ///< one a sheet, or none

  /// "sheet-01.gpgl": the file of a sheet's program.
  [[nodiscard]] std::string program_file(std::size_t sheet) const;
  [[nodiscard]] static std::string sheet_file(std::size_t sheet, const char* ending);
};

/// Reads the input and the users' tables, plans, and writes the programs.
///
/// @retval Usage       a word of an option is not known, or two contradict each other
/// @retval Malformed, OutOfRange, Infeasible  see `read_drawing`, `plan` and `encode`
[[nodiscard]] Result<PlanJob> make_plan_job(const PlanJobOptions& options);

}  // namespace popcut::cli
