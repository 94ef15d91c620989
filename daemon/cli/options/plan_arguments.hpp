// SPDX-License-Identifier: MIT
#pragma once

#include <map>
#include <string>

#include "core/result.hpp"
#include "daemon/cli/input/drawing_input.hpp"
#include "daemon/cli/parsing/command_line.hpp"
#include "daemon/planning/plan_job.hpp"

namespace popcut::cli {

using planning::PlanJob;

/// The input of a plan and its options, as they were typed.
struct PlanArguments {
  std::string input{};
  std::string machine{}, material{};
  std::map<std::string, std::string> options{};  ///< by name, in the form of a request to popcutd
  bool keep_lines{false};                        ///< the sheets keep their lines with whole folds
  bool test_shape{false};                        ///< plan the test shape instead of the input
};

/// Adds INPUT and every option of `plan_option_table`, with its range and words checked.
void add_plan_arguments(const Command& command, PlanArguments& arguments);

/// The input and the options of a plan as one types them, words quoted for a shell where they must
/// be: "card.json --machine cameo3 --mat A4 --marks".
[[nodiscard]] std::string typed_plan(const PlanArguments& arguments);

/// Says which command shows how to glue a card of parts; nothing for other drawings.
///
/// @param indent  of its line
void say_guide(const Plan& plan, const std::string& input, int indent);

/// Reads the input and the users' tables, and plans. A search for a short path that takes longer
/// shows a progress bar if `progress`, and stops after a minute for each unit of effort.
///
/// @retval Usage       an option; place is "--mat"
/// @retval Malformed, OutOfRange, Infeasible  see `read_drawing` and `make_plan_job`
[[nodiscard]] Result<PlanJob> plan_input(const PlanArguments& arguments, bool progress);

/// The same, with the design of an input that is a spec shown to `designed`.
[[nodiscard]] Result<PlanJob> plan_input(const PlanArguments& arguments, bool progress,
                                         const DesignVisitor& designed);

}  // namespace popcut::cli
