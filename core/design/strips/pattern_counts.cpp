// SPDX-License-Identifier: MIT
#include "core/design/strips/pattern_counts.hpp"

#include <algorithm>
#include <cmath>

namespace popcut {

void count_pattern(const Pattern& pattern, DesignReport& report) {
  report.faces = pattern.faces();
  double u_least = pattern.wall_mm, u_most = 0.0;
  for (const SheetLine& line : pattern.lines) {
    const double length = std::hypot(line.u1 - line.u0, line.v1 - line.v0);
    u_least = std::min({u_least, line.u0, line.u1});
    u_most = std::max({u_most, line.u0, line.u1});
    if (line.role == EdgeRole::Slit) ++report.cuts, report.cut_length_mm += length;
    if (line.role == EdgeRole::Outline) report.outline_length_mm += length;
    if (line.role == EdgeRole::Mountain || line.role == EdgeRole::Valley)
      ++report.folds, report.fold_length_mm += length;
  }
  report.sheet_u_mm = u_most - u_least;
  report.sheet_v_mm = pattern.width_mm;
}

std::vector<double> slice_places(const Strips& strips, std::size_t slices) {
  std::vector<double> place(slices), count(slices);
  for (std::size_t s = 0; s < strips.size(); ++s) {
    if (strips.kind[s] != StripKind::Slice && strips.kind[s] != StripKind::Box) continue;
    const auto j = static_cast<std::size_t>(strips.slice[s]);
    place[j] += 0.5 * (strips.v_begin[s] + strips.v_begin[s + 1]), ++count[j];
  }
  for (std::size_t j = 0; j < slices; ++j) place[j] /= count[j];
  return place;
}

}  // namespace popcut
