// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <iosfwd>

#include "core/drawing/linework.hpp"

namespace popcut {

/// Draws a dashed drawing for LightBurn: page and places in mm, one layer a colour of its palette
/// in the order of cutting: marks green (03), mountain red (02), valley blue (01), cuts and outline
/// black (00). Every dash is a solid path: dashed styles are cut solid there.
void write_lightburn_svg(const LineWork& dashed, const std::array<double, 2>& page_mm,
                         std::ostream& out);

/// Draws a drawing with whole folds for Origami Simulator: border black, mountain red, valley blue,
/// cuts green (#00ff00), plain `line` elements without transforms. Half opacity is a fold of 90
/// degrees. That program merges vertices nearer than 3 user units: the drawing is scaled so that
/// its shortest line has 30, by at most 1000. What is drawn or scored is left out.
void write_origami_sim_svg(const LineWork& whole, std::ostream& out);

}  // namespace popcut
