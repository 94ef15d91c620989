// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace popcut {

/// Where a rectangle was placed.
struct PackedBox {
  std::uint32_t sheet{};
  double x{}, y{};
  bool turned{false};  ///< turned by 90 degrees: its height lies along x
};

/// Packs rectangles of `sizes` (width and height in mm; each fits the area in at least one
/// orientation) on sheets of `area`, `spacing` mm apart, on few sheets (a heuristic). The rectangle
/// with the largest side comes first; each goes to the first sheet with room, where it raises the
/// skyline least. O(n log n + n k) for k steps of the skylines.
///
/// @return one entry per size, in the same order
[[nodiscard]] std::vector<PackedBox> pack(const std::vector<std::array<double, 2>>& sizes,
                                          const std::array<double, 2>& area, double spacing);

}  // namespace popcut
