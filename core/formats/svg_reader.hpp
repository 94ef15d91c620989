// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>

#include "core/plan/linework.hpp"
#include "core/result.hpp"

namespace popcut {

/// How a drawing says what its lines are for.
enum class SvgProfile {
  Popcut,      ///< `data-assignment`, then the name of the Inkscape layer; else a cut
  OrigamiSim,  ///< as Popcut, else by stroke colour as Origami Simulator has it
  Lightburn,   ///< as Popcut, else by stroke colour: red and blue fold, all others cut
  Cricut,      ///< as Popcut
  Plain,       ///< every stroke is a cut, whatever it is called
};

/// "popcut", "origami-sim", "lightburn", "cricut", "plain".
///
/// @retval Usage  none of these
[[nodiscard]] Result<SvgProfile> parse_svg_profile(std::string_view name);

/// The strokes of an SVG drawing in page mm; curves become chords within 0.02 mm. Sizes without a
/// unit count 96 to the inch. Paths, lines, rectangles, polylines, polygons, circles and ellipses
/// are read, in groups with transforms; what is drawn by other elements is named in the warnings.
/// Strokes dashed by their style are cut as those dashes, unless they are known to be folds.
///
/// @retval Malformed   not XML or not SVG; a path, transform or number that cannot be read; place
/// is
///                     line and column
/// @retval OutOfRange  too many points, too deep, or farther than 100 m from the origin
[[nodiscard]] Result<LineWork> linework_from_svg(std::string_view text, SvgProfile profile);

}  // namespace popcut
