// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "core/artwork/artwork.hpp"
#include "core/result.hpp"
#include "daemon/planning/views/printed_design.hpp"

namespace popcut::cli {

/// A picture (PNG) of a printed design as it stands opened, in three tiles of 480 pixels: the
/// model, the card with its artwork from the same direction, and the card from aside. A card is
/// seen from half way between wall and ground; a book from a little above, first toward its first
/// card and then from the other side. Without models there are two tiles.
///
/// @retval OutOfRange  a face is not a simple polygon
/// @retval Internal    libpng failed
[[nodiscard]] Result<std::string> print_picture(const planning::PrintedDesign& design,
                                                const Artwork& artwork);

}  // namespace popcut::cli
