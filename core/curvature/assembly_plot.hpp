// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "core/curvature/assembly.hpp"
#include "core/plot/plot.hpp"

namespace popcut {

/// A map panel of an assembly, K (`gaussian`) or H.
[[nodiscard]] plot::Panel assembly_panel(const AssemblyMaps& maps, bool gaussian,
                                         std::string title);

/// K and H of `maps` side by side as one drawing.
[[nodiscard]] std::string assembly_maps_svg(const AssemblyMaps& maps, double phi_rad);

}  // namespace popcut
