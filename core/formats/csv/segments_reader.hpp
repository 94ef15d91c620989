// SPDX-License-Identifier: MIT
#pragma once

#include <string_view>
#include <vector>

#include "core/result.hpp"

namespace popcut {

/// Which program wrote a twelve-column table of panels, and so what its coordinates mean.
enum class SegmentConvention {
  Popcut,  ///< (X, v, Z) in mm, as `write_segments_csv` writes them
  Paper,   ///< X = x, Z = 1 - y, v = z, unitless
};

/// A panel as a row gives it: the centre line from `(x0, z0)` to `(x1, z1)` in the designed pose,
/// at `v`. The panel is `width / 2` wide, half of it on either side of the line.
struct SegmentPanel {
  double x0{}, z0{};
  double x1{}, z1{};
  double v{};
  double width{};
};

inline constexpr std::size_t kMaxSegments = 5'000'000;

/// Reads a table in the format of `write_segments_csv`, in either convention. Ignores empty lines
/// and a first line of column names ("x1, ..."). Uses the coordinates (columns 1 to 6) and the
/// width (12); all twelve columns must be finite numbers.
///
/// @retval Malformed   a line does not have twelve numbers, or there are no lines; `place` is "line
///                     N"
/// @retval OutOfRange  a panel that is neither level nor upright, or not perpendicular to the
///                     spine; a width that is not positive; a coordinate beyond 100 m; too many
///                     rows
[[nodiscard]] Result<std::vector<SegmentPanel>> read_segments_csv(std::string_view text,
                                                                  SegmentConvention convention);

}  // namespace popcut
