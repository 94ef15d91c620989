// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <string>

#include "core/pattern/pattern.hpp"
#include "core/result.hpp"

namespace popcut::planning {

/// The bytes of `book.glb`: a book that opens from shut until each card has the angle that it is
/// designed for, as one animation.
///
/// @param cards  in the order of the book, each with the same design angle
/// @retval OutOfRange  too many faces (`kMaxGlbFaces`), or a face that is not a simple polygon
[[nodiscard]] Result<std::string> book_animation_glb(std::span<const Pattern* const> cards,
                                                     const std::string& name, double thickness_mm);

}  // namespace popcut::planning
