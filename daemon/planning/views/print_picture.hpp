// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <string>

#include "core/artwork/artwork.hpp"
#include "core/result.hpp"
#include "daemon/planning/views/printed_design.hpp"

namespace popcut::planning {

/// A picture (PNG) of a printed design as it stands opened, in square tiles: the model, the card
/// with its artwork from the same direction, and the card from aside. A card is seen from half way
/// between wall and ground; a book from a little above, first toward its first card and then from
/// the other side.
///
/// @param with_model  false, or no models: the two tiles of the card alone
/// @param tile_px     side of a tile
/// @retval OutOfRange  a face is not a simple polygon
/// @retval Internal    libpng failed
[[nodiscard]] Result<std::string> print_picture(const PrintedDesign& design, const Artwork& artwork,
                                                bool with_model = true, int tile_px = 480);

/// The models alone, in their colours, as the first tile of `print_picture` shows them.
[[nodiscard]] Result<std::string> model_picture(const PrintedDesign& design, int tile_px);

/// As `print_picture` of a card of boxes or of layers: the model from the front and a little from
/// above, the card from there and from both sides.
///
/// @param places      of its parts (`Plan::parts`)
/// @param with_model  false: two tiles of the card alone, from the front and from one side
[[nodiscard]] Result<std::string> print_picture(const PrintedBoxes& boxes,
                                                std::span<const DrawnPart> places,
                                                const Artwork& artwork, bool with_model = true,
                                                int tile_px = 480);

/// The same of a card of layers.
[[nodiscard]] Result<std::string> print_picture(const PrintedLayers& layers,
                                                std::span<const DrawnPart> places,
                                                const Artwork& artwork, bool with_model = true,
                                                int tile_px = 480);

}  // namespace popcut::planning
