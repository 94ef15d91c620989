// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

namespace popcut {

/// Places nearer than this are one place, mm: far below what paper or a machine can tell, far above
/// the rounding of the arithmetic that found them.
inline constexpr double kSamePlace_mm = 1e-9;

/// Gives numbers that differ by rounding only the same value: each becomes the least of its group,
/// a group reaching over less than `kSamePlace_mm`. Afterwards two of them are equal or at least
/// that far apart, and no larger than before. Order is kept, and zero stays what it is: the wall or
/// the ground. O(n log n).
///
/// Without it neighbours whose ends agree but for the last digit would be told apart by slits of
/// 1e-14 mm.
void unify_places(std::vector<double*>& places);

}  // namespace popcut
