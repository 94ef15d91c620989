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
  std::string unit;                             ///< frame_unit; "unit" if the file gives none
  bool folded_form{};                           ///< frame_classes has foldedForm
  std::optional<double> psi_rad;                ///< frame_popcut:psi_rad, if it is a number
  std::vector<std::array<double, 3>> vertices;  ///< z = 0 for vertices with two coordinates
  std::vector<std::array<std::uint32_t, 2>> edges;
  std::vector<char> assignments;        ///< B M V F U C J; U if not given
  std::vector<double> fold_angles_deg;  ///< one per edge; 0 if not given
  std::vector<std::vector<std::uint32_t>> faces;
};

/// A FOLD file: first the key frame, then the frames of `file_frames`.
struct FoldFile {
  std::string title;                     ///< file_title
  std::optional<double> design_psi_rad;  ///< popcut:design_psi_rad
  std::vector<FoldFrame> frames;
};

/// Reads FOLD 1.0 to 1.2. Accepts null entries, unknown keys, missing faces, assignments and
/// angles, and `edges_foldAngles` (1.0). Rejects invalid indices, lengths and numbers.
///
/// @retval Malformed   not JSON or not FOLD; place is a JSON pointer, or line and column
/// @retval OutOfRange  an index or number is not valid, or over a limit
[[nodiscard]] Result<FoldFile> read_fold(std::string_view text, const FoldLimits& limits = {});

/// The first frame that is flat in z, or null. Frames that are not a folded form come first,
/// because a model folded flat is flat too.
[[nodiscard]] const FoldFrame* flat_frame(const FoldFile& file);

/// The lines of the first flat frame, in page mm: x = second coordinate, y = first coordinate. This
/// is a rotation as seen from +Z, so mountains and valleys keep their side. A frame that is flat in
/// another plane is first turned to +Z, by the smallest rotation: the side from which its faces run
/// counterclockwise, or without faces the one nearest to +z, +y, +x. Where only faces are given,
/// their sides are the edges; where no edge is a border, sides of one face only are. M and V
/// become folds. C becomes a cut, and so do B edges that lie on each other (split form), once.
/// Other B edges become the outline, or a cut if they bound a hole. F, J and flat U edges are left
/// out.
///
/// @param unit_mm   of one unit, whatever the file says
/// @param enlarged  times that the lines become larger afterwards. Edges are joined, and are one
///                  where they lie on each other, as they do at that size: most programs give a
///                  square of 1 x 1 units.
/// @retval Malformed, OutOfRange  as `read_fold`; no frame is flat; coordinates beyond 100 m
[[nodiscard]] Result<LineWork> linework_from_fold(std::string_view text,
                                                  const FoldLimits& limits = {},
                                                  std::optional<double> unit_mm = {},
                                                  double enlarged = 1);

/// The same of all sheets of a file: of a card of several parts (`lists_joints`) each frame with
/// vertices, with its title as name; of any other file the one of `linework_from_fold`.
[[nodiscard]] Result<std::vector<LineWork>> sheets_from_fold(std::string_view text,
                                                             const FoldLimits& limits = {},
                                                             std::optional<double> unit_mm = {},
                                                             double enlarged = 1);

}  // namespace popcut
