// SPDX-License-Identifier: MIT
#include "core/picture/target_on_sheet.hpp"

#include <vector>

#include "core/design/shape_fit.hpp"

namespace popcut {

TriangleSoup target_on_sheet(const Design& design, bool coarse) {
  constexpr double kCoarse = 0.002;  // chords of half a millimetre's sagitta on a hand's width
  std::vector<double> s_mm;
  for (const SliceReport& slice : design.report.slices) s_mm.push_back(slice.s_mm);
  const SpineMap along(design.strips, s_mm);
  TriangleSoup soup =
      target_triangles(design.strips, along, design.report, design.target, coarse ? kCoarse : 0.0);
  for (std::size_t k = 1; k < soup.corners.size(); k += 3)
    soup.corners[k] = along.place_on_sheet(soup.corners[k]);
  return soup;
}

}  // namespace popcut
