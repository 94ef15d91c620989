// SPDX-License-Identifier: MIT
#pragma once

#include "core/design/design.hpp"
#include "core/fit/triangle_soup.hpp"

namespace popcut {

/// The target of a design where its pattern stands when it is opened to the design's angle: as
/// `target_triangles`, with places along the sheet (v) in place of those along the target.
///
/// @param coarse  for a picture: formulas are cut into triangles of about a hundredth of the
///                structure's size where the finest would be smaller
[[nodiscard]] TriangleSoup target_on_sheet(const Design& design, bool coarse);

}  // namespace popcut
