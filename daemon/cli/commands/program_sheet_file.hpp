// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "core/plan/plan.hpp"
#include "core/result.hpp"
#include "daemon/files/output_folder.hpp"

namespace popcut::cli {

/// Adds sheet `number` (from 1) as another program wants it (`planning::program_sheet`). A sheet
/// that is too large for that program's mat is noted in the plan's warnings.
[[nodiscard]] Result<void> add_program_sheet(Plan& plan, std::size_t number,
                                             std::string_view program, const std::string& title,
                                             OutputFolder& folder);

}  // namespace popcut::cli
