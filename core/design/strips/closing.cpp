// SPDX-License-Identifier: MIT
#include "core/design/strips/closing.hpp"

#include <algorithm>
#include <cmath>

namespace popcut {

double shut_reach_mm(const Strips& strips) {
  double reach = 0.0;
  for (std::size_t s = 0; s < strips.size(); ++s)
    for (std::size_t q = strips.first_point(s) + 1; q < strips.first_panel[s + 1] + s; ++q)
      reach = std::max(reach, strips.x[q] + strips.z[q]);
  return reach;
}

double shut_reach_mm(const Pattern& pattern) {
  double reach = 0.0;
  for (const PatternVertex& p : pattern.vertices)
    if (p.x > 0.0 && p.z > 0.0) reach = std::max(reach, p.x + p.z);
  for (const VFold& fold : pattern.v_folds) {
    const PatternVertex& o = pattern.vertices[fold.apex];
    const double up = fold.length_mm * std::sin(splay_rad(fold.alpha, 0.0));
    reach = std::max(reach, o.x + o.z + up);
  }
  return reach;
}

void set_card(Strips& strips, double wall_mm, double ground_mm) {
  for (std::size_t s = 0; s < strips.size(); ++s) {
    strips.z[strips.first_point(s)] = wall_mm;
    strips.x[strips.first_panel[s + 1] + s] = ground_mm;
  }
}

}  // namespace popcut
