// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "core/drawing/linework.hpp"
#include "core/plan/plan.hpp"
#include "core/result.hpp"

namespace popcut::planning {

/// The strokes of a sheet as a drawing for another program. Each stroke once, however often the
/// material has the cutter go over it, and scored stretches of dashed folds as scores: another
/// program would cut them through.
[[nodiscard]] LineWork strokes_as_lines(const PlannedSheet& sheet, FoldMode folds,
                                        const std::string& title);

inline constexpr std::string_view kDxfSheets = "dxf";  ///< a program that reads DXF

/// "sheet-01-cricut.svg", "sheet-01.dxf": the file of sheet `number` (from 1) for another program.
[[nodiscard]] std::string program_sheet_name(std::size_t number, std::string_view program);

/// Sheet `number` (from 1) as another program wants it: cricut, lightburn, origami-sim or dxf. None
/// for the other names.
///
/// @retval Infeasible  the sheet is too large for that program's mat
[[nodiscard]] Result<std::optional<std::string>> program_sheet(const Plan& plan, std::size_t number,
                                                               std::string_view program,
                                                               const std::string& title);

}  // namespace popcut::planning
