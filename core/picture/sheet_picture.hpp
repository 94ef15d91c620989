// SPDX-License-Identifier: MIT
#pragma once

#include <iosfwd>

#include "core/pattern/pattern.hpp"

namespace popcut {

/// Draws the flat sheet to be looked at, wall on top, seen from the pop-up side: paper, cuts black,
/// mountain folds red and valley folds blue, below them the name, the sheet's size, the colours and
/// a bar of round millimetres. Beyond 20 000 lines it is drawn coarser, and says so: thin lines
/// without dashes, those that fall on the same half pixels as one.
void write_sheet_picture(const Pattern& pattern, std::ostream& out);

}  // namespace popcut
