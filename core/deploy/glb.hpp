// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "core/deploy/pose_table.hpp"
#include "core/pattern/pattern.hpp"
#include "core/result.hpp"

namespace popcut {

inline constexpr std::size_t kMaxGlbFaces = 200'000;  ///< viewers give up well before

/// A picture on the front of the sheet.
struct GlbPicture {
  std::string png;                                      ///< the file's bytes; empty: none
  double left_mm{}, top_mm{}, width_mm{}, height_mm{};  ///< of the pattern's page (x = v, y = u)
};

struct GlbOptions {
  std::string creator{"popcut"};
  GlbPicture front{};
  double seconds{4};      ///< how long the animation lasts
  double thickness_mm{};  ///< 0: the sheet as a surface, else each face as a closed solid
};

/// A pattern that opens, as binary glTF 2.0: metres, y up, seen from the front (+z) with the wall
/// behind. One node a rigid face in the tree of hinges, its origin on the hinge with its parent, so
/// that the animation is rotations only; it runs through the poses of `table`, evenly in psi. At
/// rest the nodes stand in the last pose. A root node scales millimetres and turns the axes.
///
/// Two materials, front (the side on which the structure pops up) and back: surfaces are drawn
/// twice, each side with its own normal, so that neither hides in the other. Nodes are called
/// "wall N", "ground N" (in the planes of the card), "upright N", "level N" (parallel to them), or
/// "face N", N the number of the face in the pattern.
///
/// @retval OutOfRange  a face is not a simple polygon (`place` is "faces/N"); too many faces
/// @retval Internal    the glTF library failed
[[nodiscard]] Result<std::string> glb(const Pattern& pattern, const PoseTable& table,
                                      const GlbOptions& options);

/// A card of a book, with its poses. All cards of a book have the same opening angles.
struct GlbCard {
  const Pattern* pattern{};
  const PoseTable* table{};
};

/// A book that opens: cards around one spine, each turned about it by the openings of the cards
/// before it, in a node "card N" of its own. The spine is up (+y), the first ground lies along +x.
/// All cards open evenly, from the first pose to the last; else as `glb`.
///
/// @retval OutOfRange  as `glb`, for all cards together; no cards
[[nodiscard]] Result<std::string> book_glb(std::span<const GlbCard> cards, const std::string& name,
                                           const GlbOptions& options);

}  // namespace popcut
