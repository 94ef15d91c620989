// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>

#include "core/artwork/colour_mesh.hpp"
#include "core/compare/comparison.hpp"
#include "core/result.hpp"
#include "daemon/planning/search/card_search.hpp"
#include "daemon/planning/search/glued_card.hpp"

namespace popcut::planning {

/// Width and height of a thumbnail.
inline constexpr int kThumbnailWidth_px = 800, kThumbnailHeight_px = 400;

/// From where a card is drawn: along the diagonal first. Of a book: from three
/// sides, from above.
[[nodiscard]] likeness::Scene pictured_scene(const FoundCard& card, int pixels);

/// A card that was found, as a PNG without words: it needs no fonts. With its print from in front
/// and from aside, where the model has colours or is clay; else, and of a book, as bare paper
/// beside the model, in the first view of that scene and in the same frame.
///
/// @param mesh   that was searched
/// @param model  in units and axes of the file that was searched; none: cards stay bare
/// @retval Internal  libpng cannot write it
[[nodiscard]] Result<std::string> thumbnail_png(const TriangleMesh& mesh, const FoundCard& card,
                                                const std::optional<ColourMesh>& model);

/// The model in its own colours, from where `thumbnail_png` shows its printed card first.
[[nodiscard]] Result<std::string> model_png(const FoundCard& card, const ColourMesh& model);

/// As `thumbnail_png` of a card of layers or of boxes, always printed.
///
/// @param model  none: clay
[[nodiscard]] Result<std::string> thumbnail_png(const FoundGlued& card,
                                                const std::optional<ColourMesh>& model);

}  // namespace popcut::planning
