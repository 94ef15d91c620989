// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace popcut {

/// Where a rectangle went.
struct PackedBox {
  std::uint32_t sheet{};
  double x{}, y{};
  bool turned{false};  ///< by 90 degrees: its height lies along x
};

/// Packs rectangles of `sizes` (each fits the area one way) on as few sheets of `area` as the
/// heuristic finds, `spacing` mm apart: largest side first, each to where it raises the skyline
/// least, on the first sheet that takes it. O(n log n + n k) for k steps of the skylines.
[[nodiscard]] std::vector<PackedBox> pack(const std::vector<std::array<double, 2>>& sizes,
                                          const std::array<double, 2>& area, double spacing);

}  // namespace popcut
