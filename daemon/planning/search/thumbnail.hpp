// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "core/compare/comparison.hpp"
#include "core/result.hpp"
#include "daemon/planning/search/card_search.hpp"

namespace popcut::planning {

/// Width and height of a thumbnail.
inline constexpr int kThumbnailWidth_px = 640, kThumbnailHeight_px = 320;

/// From where a card is drawn: along the diagonal first. Of a book: from three
/// sides, from above.
[[nodiscard]] likeness::Scene pictured_scene(const FoundCard& card, int pixels);

/// The model and beside it the card that was found, in the first view of that scene and in the same
/// frame, as a PNG without words: it needs no fonts.
///
/// @retval Internal  libpng cannot write it
[[nodiscard]] Result<std::string> thumbnail_png(const FoundCards& found, const FoundCard& card);

}  // namespace popcut::planning
