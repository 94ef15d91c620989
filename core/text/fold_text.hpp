// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.hpp"

namespace popcut {

/// One array of a frame, flattened. Null entries are NaN.
struct FoldColumn {
  bool present{false};
  std::vector<double> number;            ///< all numbers in order; assignments as letters
  std::vector<std::uint32_t> row_first;  ///< for lists of lists: where each row begins

  /// Number of rows of a list of lists.
  [[nodiscard]] std::size_t rows() const { return row_first.size(); }
  [[nodiscard]] std::size_t row_begin(std::size_t row) const { return row_first[row]; }
  [[nodiscard]] std::size_t row_end(std::size_t row) const {
    return row + 1 < row_first.size() ? row_first[row + 1] : number.size();
  }
};

/// The members of one frame that popcut reads; all others are passed over.
struct FrameText {
  std::string place;  ///< JSON pointer of the frame, empty for the key frame
  FoldColumn vertices_coords;
  FoldColumn edges_vertices;
  FoldColumn edges_assignment;
  FoldColumn edges_fold_angle;  ///< `edges_foldAngle`, or `edges_foldAngles` of FOLD 1.0
  FoldColumn faces_vertices;
  FoldColumn model_placement;  ///< `popcut:model_placement`, of the key frame only
  std::vector<std::string> classes;
  std::string unit;
  std::string title;                     ///< `frame_title`
  std::string file_title;                ///< of the key frame only
  std::vector<std::string> other_names;  ///< the first few members that are not FOLD's
  std::optional<double> parent;
  std::optional<double> psi_rad;         ///< `frame_popcut:psi_rad`
  std::optional<double> design_psi_rad;  ///< `popcut:design_psi_rad`, of the key frame only
  bool inherit{false};
};

/// Limits on a FOLD file, checked before the memory is allocated.
struct FoldLimits {
  std::size_t bytes{std::size_t{1} << 28};  ///< of the text
  std::size_t numbers{32'000'000};          ///< numbers and rows, over all members
  std::size_t frame_bytes{400u << 20};      ///< memory of all frames, with inherited members

  /// All limits times `factor`.
  [[nodiscard]] FoldLimits raised(unsigned factor) const {
    return {bytes * factor, numbers * factor, frame_bytes * factor};
  }
};
/// The size of one `frame_unit` in mm; 1 for "unit" or none, 0 for an unknown word.
[[nodiscard]] double fold_unit_mm(std::string_view unit);

/// Whether a FOLD file is a card of several parts (docs/parts.md): it lists joints, and each frame
/// is a part.
[[nodiscard]] inline bool lists_joints(std::string_view text) {
  return text.find("\"popcut:joints\"") != std::string_view::npos;
}

inline constexpr int kMaxFoldDepth = 64;
inline constexpr std::size_t kMaxFoldFrames = 10'000;

/// Reads the JSON of a FOLD file: the arrays as they stand. Two readers check them and give them a
/// meaning: core/formats/fold/fold_reader.hpp, which is lenient, and
/// core/verify/sheet/fold_model.hpp.
///
/// Reads without building a tree: memory stays within a few times the text. Frame 0 is the key
/// frame, the others are `file_frames` in order.
///
/// @retval Malformed   not JSON (with line and column), nested too deep, or a member of another
///                     type than in FOLD 1.2 (with JSON pointer)
/// @retval OutOfRange  over a limit, or more than `kMaxFoldFrames` frames
[[nodiscard]] Result<std::vector<FrameText>> read_fold_text(std::string_view text,
                                                            const FoldLimits& limits = {});

}  // namespace popcut
