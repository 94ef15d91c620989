// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/deploy/pose_table.hpp"
#include "core/pattern/pattern.hpp"
#include "core/progress.hpp"
#include "core/result.hpp"

namespace popcut::judge {

/// How a pattern moves that popcut's own law of motion does not describe: the places of its
/// vertices at each angle that was asked for.
struct SolvedPoses {
  std::vector<double> psi_rad;
  std::vector<std::vector<Vec3>> places;  ///< one list an angle, as (x, v, z) in mm
  double slack_mm{};                      ///< how far places may be off: how exact the drawing is

  /// The table of these motions (`pose_table`), for angles that are all in `psi_rad`.
  [[nodiscard]] Result<PoseTable> table(const Pattern& pattern,
                                        std::span<const double> asked_rad) const;
};

/// A pattern that was opened from its flat sheet alone.
struct SheetMotion {
  Pattern pattern;
  std::optional<SolvedPoses> motion;  ///< none: `posed_vertices` describes how it moves
};

/// Opens a pattern of which only the flat sheet is known: a FOLD file without faces, without a
/// deployed frame, or whose panels are not all parallel to wall or ground; also the lines of a
/// drawing (`fold_from_linework`).
///
/// The sheet is rebuilt and opened as `popcut verify` does it (verify::planarise, trace_faces,
/// open_sheet). Its driving fold is laid on the v axis, with the panel on the wall's side where
/// popcut's own law of motion has it. A pattern that follows that law in the pose pi/2 follows it
/// in all, and gets `pattern` with exact places (`pattern_from_fold`); another one is opened to
/// each of `psi_rad`.
///
/// @param psi_rad  opening angles of the driving fold, from 0 to pi
/// @retval Malformed   not a FOLD file
/// @retval OutOfRange  the sheet is not one sound piece, its frames do not fit it, or it does not
///                     open as far as asked; the message says how far it does
[[nodiscard]] Result<SheetMotion> open_flat_sheet(std::string_view fold_text,
                                                  std::span<const double> psi_rad,
                                                  const Progress& progress = {});

}  // namespace popcut::judge
