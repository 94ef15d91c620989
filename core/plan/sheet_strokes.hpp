// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "core/plan/plan.hpp"

namespace popcut {

/// What is known of a stroke besides its points.
struct StrokeNote {
  std::uint8_t kind{};    ///< index into `stroke_kinds`
  std::uint32_t piece{};  ///< that it cuts, from 1 over the whole plan, as in `plan.json`
  int pass{1};            ///< over the same line, from 1; rounds of a closed line are one stroke
  double start_s{};       ///< when the tool begins to come down, since START
  double end_s{};         ///< when it is up again
};

/// "draw", "score", "mountain", "valley", "cut", "outline", and "mark" for the ticks and letters of
/// a drawing that was split.
[[nodiscard]] const std::vector<std::string_view>& stroke_kinds();

/// Notes on all strokes of the sheet's program, one for one with `PlannedSheet::sent_path`. Times
/// are those of the plan: a part of its `seconds`, without the spread. For sheets that popcut
/// drives; 0 elsewhere.
[[nodiscard]] std::vector<StrokeNote> stroke_notes(const Plan& plan, std::size_t sheet);

/// The strokes of a sheet's program for those who draw them, as JSON: the polyline of each on the
/// page (mm, x right, y down, from the corner of the sheet), with its kind, piece, pass and times.
/// Stroke i is path i of the program. Lists of numbers stand beside each other, since there may be
/// a hundred thousand strokes; lengths are rounded to 0.001 mm, times to 0.001 s.
///
/// @param side  of the sheet that is up: "pop-up", "printed" or "drawn"
[[nodiscard]] std::string sheet_strokes_json(const Plan& plan, std::size_t sheet,
                                             std::string_view side);

}  // namespace popcut
