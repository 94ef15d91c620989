// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "core/drawing/linework.hpp"
#include "core/formats/svg/svg_profile.hpp"
#include "core/formats/svg/syntax/svg_text.hpp"
#include "core/result.hpp"

namespace popcut {

/// The built-in profiles for reading the formats that popcut writes.
enum class SvgProfile { Popcut, OrigamiSim, Lightburn, Cricut, Plain };

/// "popcut", "origami-sim", "lightburn", "cricut", "plain".
[[nodiscard]] const char* svg_profile_name(SvgProfile profile);

/// Options for reading a drawing.
struct SvgReadOptions {
  StrokeProfile profile;
  double tolerance_mm{0.02};        ///< largest distance between a curve and its chords, positive
  std::optional<double> unit_mm{};  ///< of one unit of a DXF or FOLD file that is read instead
  double enlarged{1};  ///< times that the drawing becomes larger after it is read, positive
  std::vector<std::string> pens{};  ///< names for `PenFinder`; also for DXF
  bool looks{false};  ///< fill `LineWork::unsaid` and do not refuse what is unclear; also for DXF
  double dpi{96};     ///< user units (px) per inch, positive
  std::uint64_t pdf_page{1};  ///< of a PDF that becomes an SVG before, from 1
  bool weld{false};           ///< filled shapes that lie over each other become one
  SvgLimits limits;
};

/// Reads the strokes of an SVG drawing, in page mm: paths, basic shapes, `use` with symbols, and
/// nested <svg>, with transforms, viewBoxes, units, style sheets and inheritance; docs/drawings.md
/// has the full list. Warnings name what it does not read, with the number and the first place.
///
/// A stroke means what its `data-assignment` says, else the label of its layer, else what the
/// profile says about its colour and line. Cuts with a dashed style are cut as dashes; folds and
/// scores stay whole. Reads only `text`, never another file.
///
/// @retval Malformed   not XML or not SVG; an unreadable path, length or transform; a `use` of
///                     itself; a DOCTYPE with more than plain entities. Place: line, column, id
/// @retval Malformed   the profile asks, and strokes without a meaning have several colours; the
///                     reason is Unclear
/// @retval OutOfRange  over a limit, or more than 100 m from the origin
[[nodiscard]] Result<LineWork> linework_from_svg(std::string text, const SvgReadOptions& options);

/// The same with a built-in profile and default options.
[[nodiscard]] Result<LineWork> linework_from_svg(std::string_view text, SvgProfile profile);

}  // namespace popcut
