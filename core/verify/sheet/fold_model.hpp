// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/geometry/vec.hpp"
#include "core/result.hpp"

namespace popcut::verify {

/// What an edge is, by FOLD's letters. The sheet separates along `B` and `C`.
enum class Assignment : std::uint8_t { Border, Mountain, Valley, Flat, Unassigned, Cut, Join };

/// Whether the two faces beside an edge are connected there.
[[nodiscard]] constexpr bool holds(Assignment a) {
  return a != Assignment::Border && a != Assignment::Cut;
}
/// Whether the two faces beside an edge form one rigid panel.
[[nodiscard]] constexpr bool joins(Assignment a) {
  return a == Assignment::Flat || a == Assignment::Join;
}

/// The sheet in space.
struct Pose {
  std::string place;                   ///< JSON pointer of its frame, empty for the key frame
  std::vector<Vec3> at;                ///< one per vertex, mm
  std::vector<double> fold_angle_deg;  ///< the pose's own, one per edge, or empty; NaN: unknown
  std::optional<double> psi_rad;       ///< opening angle, if the file states it
  bool opened{false};                  ///< made by the solver, not from the file
};

/// A FOLD file for verify: a flat sheet and its poses. Indices are in range and numbers finite;
/// nothing else is guaranteed yet.
struct FoldModel {
  std::vector<Vec2> flat;  ///< one per vertex, mm
  std::vector<std::array<std::uint32_t, 2>> edges;
  std::vector<Assignment> assignment;  ///< one per edge
  std::vector<double> fold_angle_deg;  ///< of the key frame: one per edge, or empty; NaN: unknown
  std::vector<std::uint32_t> face_first;  ///< faces + 1 offsets into `face_vertices`
  std::vector<std::uint32_t> face_vertices;
  bool faces_given{true};  ///< false: the file has none (`trace_faces` makes them)
  std::vector<Pose> poses;
  bool from_popcut{false};               ///< a frame has `popcut:psi_rad`
  std::optional<double> design_psi_rad;  ///< `popcut:design_psi_rad`
  /// `popcut:model_placement`: how the model stands in the poses that the pattern was made from.
  /// Scale in mm, turns about x, y and z in degrees, shift in mm; a spec's scale_mm, rotate_deg
  /// and translate_mm.
  std::optional<std::array<double, 7>> model_placement;
  bool assigned{false};            ///< the file says which edges are folds and borders
  bool drawn{false};               ///< made from a drawing's lines: indices differ from the file's
  double moved_mm{};               ///< how far points of the drawing moved to meet
  std::vector<std::string> notes;  ///< what was ignored, for the user

  [[nodiscard]] std::size_t faces() const { return face_first.empty() ? 0 : face_first.size() - 1; }
};

/// Largest accepted coordinate, in mm: ten kilometres.
inline constexpr double kMaxCoordinate_mm = 1e7;

/// Reads a FOLD file. Checks that arrays have consistent lengths, indices are in range, coordinates
/// are finite, and frames inherit as FOLD 1.2 says. Converts lengths from `frame_unit` to mm. The
/// flat sheet is the key frame; if that is a folded form, it is the first flat `creasePattern`
/// frame.
///
/// @retval Malformed   not JSON, a member of a wrong type, or something missing
/// @retval OutOfRange  an index or number that is not valid, or no frame is a flat sheet
[[nodiscard]] Result<FoldModel> read_fold_model(std::string_view text);

/// A sheet of a file that holds several.
struct FoldPart {
  std::string name;   ///< frame_title
  std::string place;  ///< JSON pointer of its frame
  FoldModel sheet;    ///< without poses
};

/// Reads a FOLD file in which each frame with vertices is a flat sheet of its own, with faces and
/// fold angles. Checks as `read_fold_model`; what a frame inherits is not looked at.
///
/// @retval Malformed   as `read_fold_model`; no such frame; no faces or no fold angles
/// @retval OutOfRange  as `read_fold_model`; a frame that is not flat
[[nodiscard]] Result<std::vector<FoldPart>> read_fold_parts(std::string_view text);

}  // namespace popcut::verify
