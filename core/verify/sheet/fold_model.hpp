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

/// What an edge is, by FOLD's letters. `B` and `C` are both edges along which the sheet parts.
enum class Assignment : std::uint8_t { Border, Mountain, Valley, Flat, Unassigned, Cut, Join };

/// True where the two faces beside an edge hang together.
[[nodiscard]] constexpr bool holds(Assignment a) {
  return a != Assignment::Border && a != Assignment::Cut;
}
/// True where the two faces beside an edge are one rigid panel.
[[nodiscard]] constexpr bool joins(Assignment a) {
  return a == Assignment::Flat || a == Assignment::Join;
}

/// The sheet in space.
struct Pose {
  std::string place;                   ///< JSON pointer of its frame, empty for the key frame
  std::vector<Vec3> at;                ///< one a vertex, mm
  std::vector<double> fold_angle_deg;  ///< its own, one an edge or none at all; NaN is unknown
  std::optional<double> psi_rad;       ///< opening angle, where the file says it
  bool opened{false};                  ///< made by the solver, not by the file
};

/// A FOLD file as verify needs it: a flat sheet and the poses that it takes. Indices are in range
/// and numbers finite; nothing else is promised yet.
struct FoldModel {
  std::vector<Vec2> flat;  ///< one a vertex, mm
  std::vector<std::array<std::uint32_t, 2>> edges;
  std::vector<Assignment> assignment;     ///< one an edge
  std::vector<double> fold_angle_deg;     ///< of the key frame: one an edge or none; NaN is unknown
  std::vector<std::uint32_t> face_first;  ///< faces + 1 offsets into `face_vertices`
  std::vector<std::uint32_t> face_vertices;
  bool faces_given{true};  ///< false: the file lists none (`trace_faces` makes them)
  std::vector<Pose> poses;
  bool from_popcut{false};         ///< a frame tells `popcut:psi_rad`
  bool assigned{false};            ///< the file says which edges are folds and borders
  bool drawn{false};               ///< made of a drawing's lines: its indices are not the file's
  double moved_mm{};               ///< how far the drawing's points were moved to make them meet
  std::vector<std::string> notes;  ///< what was passed over, for the user

  [[nodiscard]] std::size_t faces() const { return face_first.empty() ? 0 : face_first.size() - 1; }
};

/// Largest coordinate that is accepted, in mm: ten kilometres.
inline constexpr double kMaxCoordinate_mm = 1e7;

/// Reads a FOLD file: arrays agree in length, indices are in range, coordinates are finite and the
/// frames inherit as FOLD 1.2 says. Lengths come out in mm, whatever `frame_unit` is. The flat
/// sheet is the key frame, or where that is a folded form, the first flat `creasePattern` frame.
///
/// @retval Malformed   not JSON, a member of a wrong type, something missing
/// @retval OutOfRange  an index or number that is not lawful, or no frame is a flat sheet
[[nodiscard]] Result<FoldModel> read_fold_model(std::string_view text);

}  // namespace popcut::verify
