// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/drawing/linework.hpp"
#include "core/result.hpp"
#include "core/text/fold_text.hpp"

namespace popcut {

/// One frame of a FOLD file as it stands, with what it inherits filled in.
struct FoldFrame {
  std::string title;
  std::string unit;                             ///< frame_unit, "unit" where none is given
  bool folded_form{};                           ///< frame_classes has foldedForm
  std::optional<double> psi_rad;                ///< frame_popcut:psi_rad, where it is a number
  std::vector<std::array<double, 3>> vertices;  ///< z = 0 where two coordinates are given
  std::vector<std::array<std::uint32_t, 2>> edges;
  std::vector<char> assignments;        ///< B M V F U C J, U where none is given
  std::vector<double> fold_angles_deg;  ///< one an edge, 0 where none is given
  std::vector<std::vector<std::uint32_t>> faces;
};

/// A FOLD file: the key frame, then those of `file_frames`.
struct FoldFile {
  std::string title;  ///< file_title
  std::vector<FoldFrame> frames;
};

/// Reads FOLD 1.0 to 1.2. Tolerant of null entries, unknown keys, missing faces, assignments and
/// angles, `edges_foldAngles` (1.0); strict about indices, lengths and numbers.
///
/// @retval Malformed   not JSON, or not of FOLD's form; place is a JSON pointer or line and column
/// @retval OutOfRange  an index or number that is not lawful, or over a limit
[[nodiscard]] Result<FoldFile> read_fold(std::string_view text, const FoldLimits& limits = {});

/// The first frame that lies flat in z, frames that are no folded form first (a model folded flat
/// lies flat, too); null if there is none.
[[nodiscard]] const FoldFrame* flat_frame(const FoldFile& file);

/// How many mm one unit of `frame_unit` is; 1 for "unit", 0 for a word that is not known.
[[nodiscard]] double fold_unit_mm(const std::string& unit);

/// The lines of the first flat frame, in page mm: x = second coordinate, y = first, which is a
/// rotation as seen from +Z, so that mountain and valley keep their side. M and V are folds; C, and
/// B edges that lie on each other (split form), a cut, once; other B edges the outline, or a cut
/// where they bound a hole. F, J and flat U edges are left out.
///
/// @retval Malformed, OutOfRange  as `read_fold`; no frame lies flat in z; coordinates beyond 100 m
[[nodiscard]] Result<LineWork> linework_from_fold(std::string_view text,
                                                  const FoldLimits& limits = {});

}  // namespace popcut
