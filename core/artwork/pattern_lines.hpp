// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <string>

#include "core/artwork/colour_mesh.hpp"
#include "core/artwork/pixel_frame.hpp"
#include "core/pattern/pattern.hpp"
#include "core/result.hpp"

namespace popcut {

/// Artwork as lines, SVG elements on the page of the pattern (x = v, y = u, mm): the panels of the
/// structure in the grey that their direction gives them (upright ones darker than level ones; wall
/// and ground stay paper), and over them the edges of the model that are seen from (1, 0, 1):
/// outlines, borders, and edges where its faces turn by over 30 degrees.
///
/// An edge is seen where it is not behind the model by more than two pixels of `frame`, which says
/// how finely that is looked at; it ends within a pixel of where it goes behind.
///
/// @param parts   on one page (`Pattern::place`)
/// @param models  one a part, see `model_on_sheet`
/// @param trap_mm  how far a panel's grey goes over its border, below its neighbours
[[nodiscard]] Result<std::string> pattern_lines(std::span<const Pattern> parts,
                                                std::span<const ColourMesh> models,
                                                const PixelFrame& frame, double trap_mm);

}  // namespace popcut
