// SPDX-License-Identifier: MIT
#include "daemon/cli/commands/program_sheet_file.hpp"

#include <fmt/format.h>

#include "daemon/planning/make/program_sheets.hpp"

namespace popcut::cli {

Result<void> add_program_sheet(Plan& plan, std::size_t number, std::string_view program,
                               const std::string& title, OutputFolder& folder) {
  const std::string name = planning::program_sheet_name(number, program);
  const auto written = planning::program_sheet(plan, number, program, title);
  if (written) return *written ? folder.add(name, **written) : Result<void>{};
  plan.warnings.push_back(
      {.code = "not_written",
       .message = fmt::format("{} is not written: {}", name, written.error().detail),
       .place = {.sheet = static_cast<int>(number)}});
  return {};
}

}  // namespace popcut::cli
