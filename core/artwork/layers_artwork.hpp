// SPDX-License-Identifier: MIT
#pragma once

#include <span>

#include "core/artwork/colour_mesh.hpp"
#include "core/artwork/design_artwork.hpp"
#include "core/design/layers/layered_card.hpp"
#include "core/plan/plan.hpp"
#include "core/result.hpp"

namespace popcut {

/// A model where it stands on a card of layers, as `LayeredCard::target`.
///
/// @param model  in units and axes of the spec's surface
[[nodiscard]] ColourMesh model_on_card(const LayeredCard& made, ColourMesh model);

/// The target of a card of layers as a model of clay.
[[nodiscard]] ColourMesh clay_on_card(const LayeredCard& made);

/// What is printed on the layers of a card: on each the model as it is seen from the front, of
/// which it shows what is nearer to it than to other layers; where there is nothing of that, what
/// is nearest in front of it, or behind it. Pages, tabs and strips beyond the model stay bare.
///
/// @param model   `model_on_card`
/// @param places  of the parts on their common page (`Plan::parts`): x = v, y = u of each sheet
/// @param options `PrintMode::View` and `Surface` are one here
/// @retval OutOfRange  more than `kMaxPixels`; a mode that is not for layers; a face that is not a
///                     simple polygon
/// @retval Infeasible  nothing of the model is seen on the card
[[nodiscard]] Result<Artwork> layers_artwork(const LayeredCard& made, const ColourMesh& model,
                                             std::span<const DrawnPart> places,
                                             const ArtworkOptions& options);

/// The printed card as it stands open flat, (x, v, z) in mm for a person who looks at its front: x
/// toward that person, v to the right. The printed sides are where triangles run counter-clockwise.
[[nodiscard]] ColourMesh standing_layers(const LayeredCard& made, std::span<const DrawnPart> places,
                                         const Artwork& artwork);

/// A model on the card (`model_on_card`) as that person sees it.
[[nodiscard]] ColourMesh as_seen_in_front(const LayeredCard& made, ColourMesh model);

}  // namespace popcut
