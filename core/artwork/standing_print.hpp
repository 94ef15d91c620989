// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>

#include "core/artwork/artwork.hpp"
#include "core/artwork/colour_mesh.hpp"
#include "core/pattern/pattern.hpp"
#include "core/result.hpp"

namespace popcut {

/// How the parts of a design stand when it is opened.
enum class PartsStand : std::uint8_t {
  InRow,   ///< side by side along one spine, each at its place
  Around,  ///< as the cards of a book: each turned about the spine by the angles of those before it
};

/// A printed design as it stands opened as it was designed: its panels as triangles with the
/// artwork on them, in space, (x, v, z), mm. Their fronts, where they run counter-clockwise, are
/// the printed side. What has no ink is white.
///
/// @param artwork  `design_artwork` of the same parts
/// @retval OutOfRange  as `face_surface`
[[nodiscard]] Result<ColourMesh> standing_print(std::span<const Pattern* const> parts,
                                                PartsStand stand, const Artwork& artwork);

/// The models whose colours are printed on the parts, as they stand in the opened design.
///
/// @param models  one a part, see `model_on_sheet`
[[nodiscard]] ColourMesh standing_models(std::span<const Pattern* const> parts, PartsStand stand,
                                         std::span<const ColourMesh> models);

}  // namespace popcut
