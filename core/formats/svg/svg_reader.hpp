// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>

#include "core/formats/svg/svg_profile.hpp"
#include "core/formats/svg/syntax/svg_text.hpp"
#include "core/drawing/linework.hpp"
#include "core/result.hpp"

namespace popcut {

/// The built-in profiles that popcut's own drawings are read back with.
enum class SvgProfile { Popcut, OrigamiSim, Lightburn, Cricut, Plain };

/// "popcut", "origami-sim", "lightburn", "cricut", "plain".
[[nodiscard]] const char* svg_profile_name(SvgProfile profile);

/// How a drawing is read.
struct SvgReadOptions {
  StrokeProfile profile;
  double tolerance_mm{0.02};  ///< between a curve and its chords, positive
  double dpi{96};             ///< user units (px) to the inch, positive
  SvgLimits limits;
};

/// The strokes of an SVG drawing in page mm. Read are paths, basic shapes, `use` with symbols, and
/// nested <svg>, with transforms, viewBoxes, units, style sheets and inheritance; docs/drawings.md
/// has the whole list. What is not read is named in the warnings, with the number and the first.
///
/// A stroke is what its `data-assignment` says, else the label of its layer, else what the profile
/// says of its colour and line. Cuts that are dashed by their style are cut as those dashes; folds
/// and scores stay whole. Nothing but `text` is ever read.
///
/// @retval Malformed   not XML or not SVG; a path, length or transform that cannot be read; a `use`
///                     of itself; a DOCTYPE with more than plain entities. Place: line, column, id
/// @retval OutOfRange  over a limit, or farther than 100 m from the origin
[[nodiscard]] Result<LineWork> linework_from_svg(std::string text, const SvgReadOptions& options);

/// The same with a built-in profile and the usual options.
[[nodiscard]] Result<LineWork> linework_from_svg(std::string_view text, SvgProfile profile);

}  // namespace popcut
