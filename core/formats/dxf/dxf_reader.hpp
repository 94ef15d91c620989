// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/drawing/linework.hpp"
#include "core/formats/pens/layer_words.hpp"
#include "core/result.hpp"

namespace popcut {

/// What colours mean for lines on layers with unknown names.
enum class DxfColours {
  Ignored,     ///< cut all lines
  Asked,       ///< cut all lines of one colour; refuse several colours of solid lines, and names
               ///< that are not known beside names that are
  OrigamiSim,  ///< red mountain, blue valley, green cut, black or white outline, others left out
  Lightburn,   ///< red mountain, blue valley, others cut
};

/// Options and limits for reading a drawing.
struct DxfOptions {
  DxfColours colours{DxfColours::Ignored};
  LayerUses layers{};                   ///< what a person says of layers
  std::vector<ColourUse> said{};        ///< and of colours, of lines whose layer says nothing
  bool looks{false};                    ///< fill `LineWork::unsaid`, and refuse nothing unclear
  std::vector<std::string> pens{};      ///< names for `PenFinder`
  std::optional<double> unit_mm{};      ///< of one unit, whatever the file says
  double tolerance_mm{0.02};            ///< largest distance between a curve and its chords
  std::size_t most_bytes{256u << 20};   ///< of the file
  std::size_t most_points{10'000'000};  ///< of the drawing, with curves as chords
  std::size_t most_lines{50'000'000};   ///< lines of text read, counting repeats for inserts
  std::size_t most_deep{32};            ///< nesting depth of inserts

  /// All limits times `factor`, except the depth. The file and its points stay below 2^31.
  [[nodiscard]] DxfOptions raised(unsigned factor) const;
};

/// Reads the lines of a DXF drawing, ASCII (R9 to R2018) or binary, in page mm: x to the right, y
/// down.
///
/// Reads LINE, LWPOLYLINE, POLYLINE, ARC, CIRCLE, ELLIPSE and SPLINE of the model space, also
/// through INSERTs of blocks. Warnings name everything else. The name of a layer decides what its
/// lines are for (`layer_meaning`), on layer 0 that of the block; other lines are cut. Lines of a
/// dashed line type are cut as dashes, with a whole number of periods and a gap at both ends; if
/// the file does not define the dashes, the lines become valley folds. Layers that are off, frozen
/// or not plotted are left out, with a warning. Solids are seen from above. A drawing that lies
/// more than 100 m from its origin is moved there, with a warning.
///
/// @retval Malformed   not a DXF, truncated, an invalid group, or a block that inserts
///                     itself; place is the line, of a binary DXF the group
/// @retval Malformed   colours are Asked, and lines on layers without a known name have several, or
///                     a name is not known and another is; the reason is Unclear
/// @retval OutOfRange  larger than `options` allow, or with lines more than 100 m apart
[[nodiscard]] Result<LineWork> linework_from_dxf(std::string_view text,
                                                 const DxfOptions& options = {});

}  // namespace popcut
