// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string_view>

#include "core/drawing/linework.hpp"
#include "core/result.hpp"

namespace popcut {

/// Whether colours say what lines on layers of no known name are for.
enum class DxfColours {
  Ignored,     ///< all are cut
  OrigamiSim,  ///< red mountain, blue valley, green cut, black or white outline, others nothing
  Lightburn,   ///< red mountain, blue valley, others cut
};

struct DxfOptions {
  DxfColours colours{DxfColours::Ignored};
  double tolerance_mm{0.02};            ///< between a curve and its chords
  std::size_t most_bytes{256u << 20};   ///< of the file
  std::size_t most_points{10'000'000};  ///< of the drawing, curves flattened
  std::size_t most_lines{50'000'000};   ///< of text read again for inserts
  std::size_t most_deep{32};            ///< inserts within inserts

  /// All that is counted times `factor`; the file and its points stay below 2^31.
  [[nodiscard]] DxfOptions raised(unsigned factor) const;
};

/// The lines of an ASCII DXF drawing (R9 to R2018) in page mm: x to the right, y turned down.
///
/// Read are LINE, LWPOLYLINE, POLYLINE, ARC, CIRCLE, ELLIPSE and SPLINE of the model space, also
/// through INSERTs of blocks; all else is named in the warnings. Names of layers say what a line is
/// for (`dxf_meaning`): on others it is cut. Lines of a dashed line type are cut as these dashes,
/// a whole number of periods with a gap at both ends; where the file does not say how long the
/// dashes are, they are folds (valley). Layers that are off, frozen or not plotted are left out and
/// named. Solids are seen from above.
///
/// @retval Malformed   no ASCII DXF, truncated, a wrong group, a block that inserts itself; place
///                     is the line
/// @retval OutOfRange  larger than `options` allow, or farther than 100 m from the origin
[[nodiscard]] Result<LineWork> linework_from_dxf(std::string_view text,
                                                 const DxfOptions& options = {});

}  // namespace popcut
