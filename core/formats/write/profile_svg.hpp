// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <iosfwd>

#include "core/drawing/linework.hpp"

namespace popcut {

/// Writes a dashed drawing for LightBurn: page and coordinates in mm, one layer per colour of its
/// palette, in cutting order: marks green (03), mountain red (02), valley blue (01), cuts and
/// outline black (00). Every dash is a solid path, because LightBurn cuts dashed styles as solid
/// lines.
void write_lightburn_svg(const LineWork& dashed, const std::array<double, 2>& page_mm,
                         std::ostream& out);

/// Writes a drawing with whole folds for Origami Simulator: border black, mountain red, valley
/// blue, cuts green (#00ff00), as plain `line` elements without transforms. Half opacity means a
/// fold of 90 degrees. Origami Simulator merges vertices closer than 3 user units, so the drawing
/// is scaled until its shortest line has 30, by at most 1000. Pen and score lines are left out.
void write_origami_sim_svg(const LineWork& whole, std::ostream& out);

}  // namespace popcut
