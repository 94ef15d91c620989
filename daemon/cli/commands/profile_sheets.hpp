// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>

#include "core/drawing/linework.hpp"
#include "core/plan/plan.hpp"
#include "core/result.hpp"
#include "daemon/files/output_folder.hpp"

namespace popcut::cli {

/// The strokes of a sheet as a drawing for another program. Each stroke once, however often the
/// material has the cutter go over it, and scored stretches of dashed folds as scores: another
/// program would cut them through.
[[nodiscard]] LineWork strokes_as_lines(const PlannedSheet& sheet, FoldMode folds,
                                        const std::string& title);

/// Adds sheet `number` (from 1) as another program wants it, `sheet-NN-PROFILE.svg`, for the
/// profiles cricut, lightburn and origami-sim; nothing for the others. A sheet that is too large
/// for that program's mat is noted in the plan's warnings.
[[nodiscard]] Result<void> add_profile_sheet(Plan& plan, std::size_t number,
                                             const std::string& profile, const std::string& title,
                                             OutputFolder& folder);

}  // namespace popcut::cli
