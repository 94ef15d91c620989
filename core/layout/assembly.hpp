// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "core/layout/layout.hpp"

namespace popcut {

/// How the pieces come together, to look at: the whole drawing with each piece in its own tint, its
/// number and sheet, seams with their letters, tabs, and the steps of glueing beside it. In mm.
[[nodiscard]] std::string assembly_svg(const Layout& layout, const LineWork& drawing);

}  // namespace popcut
