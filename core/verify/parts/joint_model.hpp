// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/geometry/vec.hpp"
#include "core/result.hpp"
#include "core/verify/sheet/fold_model.hpp"

namespace popcut::verify {

/// A part of a card: a sheet of its own.
struct CardPart {
  std::string name;   ///< frame_title
  std::string place;  ///< JSON pointer of its frame
  FoldModel sheet;    ///< flat, with the fold angles of one opened pose; no poses
};

/// What holds two parts together.
enum class JointKind : std::uint8_t {
  Hinge,  ///< both faces turn about one line
  Glue,   ///< the first face is a tab that lies flat on the second one
  Slot,   ///< the second face slides through a slit of the first part, so it holds the slit's line
  Cross   ///< two faces cross in a line; each has a slot over a part of it
};

/// One side of a joint: a face, and a line in its sheet.
struct JointSide {
  std::size_t part{}, face{};
  std::array<Vec2, 2> line;  ///< not of the second side of a slot
};

struct CardJoint {
  JointKind kind{};
  std::string place;  ///< JSON pointer
  JointSide a, b;
  /// The second sheet lies on its back where the first one lies on its face.
  bool turned{};
  double angle_deg{};  ///< of a hinge or a crossing in the opened pose, as a fold angle
};

/// A card of several parts, as its FOLD file gives it.
struct JointModel {
  std::string title;  ///< file_title
  std::vector<CardPart> parts;
  std::vector<CardJoint> joints;
  double thickness_mm{0.3};  ///< `popcut:thickness_mm`
  double opens_deg{180.0};   ///< `popcut:opens_deg`: between the pages of the open card
  /// `popcut:pages`: the faces of the first part that are its pages. None: those on both sides of
  /// its longest fold.
  std::optional<std::array<std::size_t, 2>> pages;
};

inline constexpr std::size_t kMostParts = 400, kMostJoints = 4000;

/// Reads a FOLD file with `popcut:joints` (docs/parts.md): each frame with vertices is a part.
/// Indices are in range, names are known and lines have a length; nothing else is guaranteed.
///
/// @retval Malformed   not JSON, a member of a wrong type, an unknown part, or something missing
/// @retval OutOfRange  an index or number that is not valid, or too many parts or joints
[[nodiscard]] Result<JointModel> read_joint_model(std::string_view text);

}  // namespace popcut::verify
