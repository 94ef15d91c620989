// SPDX-License-Identifier: MIT
#pragma once

#include <optional>

#include "core/design/patches.hpp"
#include "core/fit/triangle_soup.hpp"

namespace popcut {

/// Triangles of card `card` of a book as it stands among the others: turned about the spine by
/// `card` times the angle of the cards, from the ground of the first card toward its wall.
[[nodiscard]] TriangleSoup turned_in_book(TriangleSoup soup, double angle_deg, std::size_t card);

/// The structures of all cards where they stand, without their pages. Places along the spine are
/// those along the target: `BookReport::shift_mm` less than on the sheets.
[[nodiscard]] TriangleSoup book_structure(const PatchAssembly& book);

/// The whole target about the spine, where the structures of `book_structure` stand.
[[nodiscard]] TriangleSoup book_target(const PatchAssembly& book);

/// How near a book comes to its whole target, in every direction about the spine: each point of the
/// target against the nearest card. Pages do not count. None where target or structure has no area.
[[nodiscard]] std::optional<BookFit> book_fit(const PatchAssembly& book);

}  // namespace popcut
