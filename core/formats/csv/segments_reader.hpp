// SPDX-License-Identifier: MIT
#pragma once

#include <string_view>
#include <vector>

#include "core/result.hpp"

namespace popcut {

/// Who wrote a twelve-column table of panels, hence what its coordinates are.
enum class SegmentConvention {
  Popcut,  ///< (X, v, Z) in mm, as `write_segments_csv` writes them
  Paper,   ///< X = x, Z = 1 - y, v = z, without a unit
};

/// A panel as a row has it: the centre line from `(x0, z0)` to `(x1, z1)` in the designed pose, at
/// `v`; the panel is `width / 2` wide, half of that on either side.
struct SegmentPanel {
  double x0{}, z0{};
  double x1{}, z1{};
  double v{};
  double width{};
};

inline constexpr std::size_t kMaxSegments = 5'000'000;

/// Reads the table that `write_segments_csv` describes, in either convention. A first line of
/// column names ("x1, ...") is passed over, and so are empty lines. Of the twelve columns the
/// places (1 to 6) and the width (12) are used; all must be finite numbers.
///
/// @retval Malformed   a line has not twelve numbers, or there is none; `place` is "line N"
/// @retval OutOfRange  a panel that is neither level nor upright or not square to the spine, a
///                     width that is not positive, a place beyond 100 m, too many rows
[[nodiscard]] Result<std::vector<SegmentPanel>> read_segments_csv(std::string_view text,
                                                                  SegmentConvention convention);

}  // namespace popcut
