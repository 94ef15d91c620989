// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

#include "core/design/patches.hpp"
#include "core/design/spec/spec.hpp"
#include "core/progress.hpp"
#include "core/result.hpp"

namespace popcut {

/// Whether a book turns its target from card to card. A profile, a loft and a grid describe what
/// stands in one corner: then every card shows it.
[[nodiscard]] bool turns_with_cards(const SurfaceSpec& surface);

/// How a book's target stands about the spine, for its first card. A mesh has its z axis along the
/// spine where the spec gives no rotate_deg, and the middle of its box on the spine, halfway along
/// the slices, where it gives no translate_mm. All others stand as the spec says.
///
/// @retval Malformed, OutOfRange  the mesh cannot be read or placed
[[nodiscard]] Result<TargetPlacement> book_placement(const DesignSpec& spec,
                                                     const SurfaceAssets& assets);

/// The spec of one card of a book, a design of its own: the target turned about the spine by
/// `card` times the angle of the cards, which is its design angle.
///
/// @param placement  `book_placement`
[[nodiscard]] DesignSpec card_of_book(const DesignSpec& spec, const TargetPlacement& placement,
                                      std::size_t card);

/// Designs a book: its cards are the parts. All have the same page, large enough that each shut
/// structure lies inside, and the same places along the spine. A card that the target does not
/// reach is plain: wall, ground and the fold between them. Cards that would be the same are
/// designed once.
///
/// A structure in oblique coordinates stays in the wedge between its wall and its ground at every
/// opening (docs/geometry.md, section 2), so that cards never meet, and two cards on either side of
/// a page share nothing but the page.
///
/// @retval Infeasible  no card shows anything, or one cannot be designed; place is that of `design`
[[nodiscard]] Result<PatchAssembly> design_book(const DesignSpec& spec, const SurfaceAssets& assets,
                                                const Progress& progress = {});

}  // namespace popcut
