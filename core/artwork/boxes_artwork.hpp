// SPDX-License-Identifier: MIT
#pragma once

#include <span>

#include "core/artwork/colour_mesh.hpp"
#include "core/artwork/design_artwork.hpp"
#include "core/design/boxes/boxed_card.hpp"
#include "core/plan/plan.hpp"
#include "core/result.hpp"

namespace popcut {

/// A model where it stands on a card of boxes, as `BoxedCard::target`.
///
/// @param model  in units and axes of the spec's surface
[[nodiscard]] ColourMesh model_on_card(const BoxedCard& made, ColourMesh model);

/// The target of a card of boxes as a model of clay.
[[nodiscard]] ColourMesh clay_on_card(const BoxedCard& made);

/// What is printed on the boxes of a card: on each panel what of the model is near it, as seen
/// square to it from outside: windows and doors that stand out of a wall are printed on it. Pages
/// and tabs stay bare.
///
/// @param model   `model_on_card`
/// @param places  of the parts on their common page (`Plan::parts`): x = v, y = u of each sheet
/// @retval OutOfRange  more than `kMaxPixels`; a mode that is not for boxes
[[nodiscard]] Result<Artwork> boxes_artwork(const BoxedCard& made, const ColourMesh& model,
                                            std::span<const DrawnPart> places,
                                            const ArtworkOptions& options);

/// A model on the card (`model_on_card`), or the printed card, for a person who looks at its front:
/// x toward that person, v to the right.
[[nodiscard]] ColourMesh as_seen_in_front(const BoxedCard& made, ColourMesh model);

/// The printed card as it stands open flat: x across the pages, v along the spine, z up.
[[nodiscard]] ColourMesh standing_boxes(const BoxedCard& made, std::span<const DrawnPart> places,
                                        const Artwork& artwork);

}  // namespace popcut
