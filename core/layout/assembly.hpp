// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "core/layout/layout.hpp"

namespace popcut {

/// Draws how to glue the pieces together, in mm: the whole drawing with each piece in its own tint,
/// with its number and sheet, the seams with their letters, the tabs, and a list of the glueing
/// steps.
[[nodiscard]] std::string assembly_svg(const Layout& layout, const LineWork& drawing);

}  // namespace popcut
