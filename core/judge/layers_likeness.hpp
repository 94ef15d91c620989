// SPDX-License-Identifier: MIT
#pragma once

#include <span>

#include "core/compare/picture.hpp"
#include "core/compare/printed.hpp"
#include "core/design/layers/layered_card.hpp"

namespace popcut::judge {

/// How a printed card of layers looks beside its target, from 20 to 60 degrees above the open page
/// (`likeness::page_views`), or around the diagonal of a card that opens to 90 degrees: what
/// `PrintedFigures` are for a card of one sheet.
///
/// @param colours  of the target's triangles, one each; any other number: clay
[[nodiscard]] likeness::PrintedFigures layers_likeness(const LayeredCard& made,
                                                       std::span<const likeness::Rgb> colours,
                                                       int pixels = 512);

}  // namespace popcut::judge
