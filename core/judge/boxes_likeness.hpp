// SPDX-License-Identifier: MIT
#pragma once

#include <span>

#include "core/compare/picture.hpp"
#include "core/compare/printed.hpp"
#include "core/design/boxes/boxed_card.hpp"

namespace popcut::judge {

/// How a printed card of boxes (`boxes_artwork`) looks beside its target, from the sides that
/// `layers_likeness` looks from; a card of facets with glued roofs from around the diagonal, in the
/// corner of its pages, which are bare.
///
/// @param colours  of the target's triangles, one each; any other number: clay
[[nodiscard]] likeness::PrintedFigures boxes_likeness(const BoxedCard& made,
                                                      std::span<const likeness::Rgb> colours,
                                                      int pixels = 512);

}  // namespace popcut::judge
