// SPDX-License-Identifier: MIT
#pragma once

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

}  // namespace popcut::planning
