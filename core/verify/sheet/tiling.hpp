// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "core/geometry/triangulate.hpp"
#include "core/verify/sheet/check.hpp"
#include "core/verify/sheet/fold_model.hpp"
#include "core/verify/sheet/sheet.hpp"

namespace popcut::verify {

/// The faces as triangles: those of face f are `first[f] .. first[f + 1]`.
struct Triangles {
  std::vector<Triangle> corners;
  std::vector<std::uint32_t> first;
  std::vector<std::uint32_t> face;  ///< one per triangle
};

/// Checks that every face is a simple, counter-clockwise polygon. Returns the faces as triangles,
/// without those of faces that fail.
[[nodiscard]] Triangles check_faces(const FoldModel& file, VerifyCheck& check);

/// Checks that the faces tile the sheet: no two overlap, and their areas add up to what the outer
/// border encloses minus the holes. Two faces overlap if they share more area than lines off by
/// `slack_mm` would cause.
[[nodiscard]] Tiling check_tiling(const FoldModel& file, const Sheet& sheet,
                                  const Triangles& triangles, double slack_mm, VerifyCheck& check);

/// Checks the lines of the sheet: no two edges cross, no vertex lies inside a fold, and no two
/// edges run along each other, except the two sides of a slit.
void check_lines(const FoldModel& file, const Sheet& sheet, double slack_mm, VerifyCheck& check);

}  // namespace popcut::verify
