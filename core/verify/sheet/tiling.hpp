// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "core/geometry/triangulate.hpp"
#include "core/verify/sheet/check.hpp"
#include "core/verify/sheet/fold_model.hpp"
#include "core/verify/sheet/sheet.hpp"

namespace popcut::verify {

/// The faces in triangles: those of face f are `first[f] .. first[f + 1]`.
struct Triangles {
  std::vector<Triangle> corners;
  std::vector<std::uint32_t> first;
  std::vector<std::uint32_t> face;  ///< one a triangle
};

struct Tiling {
  double sheet_u_mm{}, sheet_v_mm{};  ///< extent of the flat sheet
  double area_mm2{};                  ///< sum of the faces' areas
  double outline_mm2{};               ///< area that the outer borders enclose
  double holes_mm2{};
  std::size_t holes{};
  std::size_t slits{};  ///< loops of border that enclose nothing
};

/// Does every face bound a simple, counter-clockwise polygon? Gives the faces in triangles; those
/// of a face that fails are left out.
[[nodiscard]] Triangles check_faces(const FoldModel& file, VerifyCheck& check);

/// Do the faces tile the sheet: no two overlap in their interior, and their areas sum up to what
/// the outer border encloses less the holes? Two faces overlap when they share more area than
/// lines that are `slack_mm` off would give.
[[nodiscard]] Tiling check_tiling(const FoldModel& file, const Sheet& sheet,
                                  const Triangles& triangles, double slack_mm, VerifyCheck& check);

/// Do the lines lie as lines of one sheet must: no two edges cross, no vertex lies inside a fold,
/// and no two edges run along each other, save the two sides of one slit?
void check_lines(const FoldModel& file, const Sheet& sheet, double slack_mm, VerifyCheck& check);

}  // namespace popcut::verify
