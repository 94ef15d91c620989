// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "core/plan/plan.hpp"
#include "core/result.hpp"
#include "daemon/files/output_folder.hpp"

namespace popcut::cli {

/// Adds sheet `number` (from 1) as another program wants it, `sheet-NN-PROFILE.svg`, for the
/// profiles cricut, lightburn and origami-sim; nothing for the others. A sheet that is too large
/// for that program's mat is noted in `warnings`.
[[nodiscard]] Result<void> add_profile_sheet(const PlannedSheet& sheet, std::size_t number,
                                             const std::string& profile, const std::string& title,
                                             OutputFolder& folder,
                                             std::vector<std::string>& warnings);

}  // namespace popcut::cli
