// SPDX-License-Identifier: MIT
#include "core/design/strips/pattern_join.hpp"

#include <algorithm>

#include "core/design/strips/same_place.hpp"

namespace popcut {

JoinedStrips join_strips(std::span<const Strips* const> patches, double wall_mm, double ground_mm) {
  JoinedStrips out;
  Strips& to = out.strips;
  to.v_begin.push_back(0.0);
  to.first_panel.push_back(0);
  PlaneId planes = kGroundPlane + 1;  // the next free one
  std::int32_t slices = 0;
  for (std::size_t k = 0; k < patches.size(); ++k) {
    const Strips& from = *patches[k];
    const PlaneId shift = planes - (kGroundPlane + 1);
    out.first_slice.push_back(slices);
    std::int32_t last_slice = -1;
    for (std::size_t s = 0; s < from.size(); ++s) {
      const bool inner = from.kind[s] == StripKind::Margin && !(k == 0 && s == 0) &&
                         !(k + 1 == patches.size() && s + 1 == from.size());
      if (inner) continue;
      to.kind.push_back(from.kind[s]);
      to.slice.push_back(from.slice[s] < 0 ? -1 : from.slice[s] + slices);
      last_slice = std::max(last_slice, from.slice[s]);
      to.v_begin.push_back(to.v_begin.back() + (from.v_begin[s + 1] - from.v_begin[s]));
      for (std::uint32_t p = from.first_panel[s]; p < from.first_panel[s + 1]; ++p) {
        const PlaneId plane = from.plane[p];
        to.plane.push_back(plane <= kGroundPlane ? plane : plane + shift);
        to.level.push_back(from.level[p]);
        planes = std::max(planes, to.plane.back() + 1);
      }
      const std::size_t first = from.first_point(s), last = from.first_panel[s + 1] + s;
      for (std::size_t q = first; q <= last; ++q) {
        to.x.push_back(q == last ? ground_mm : from.x[q]);
        to.z.push_back(q == first ? wall_mm : from.z[q]);
      }
      to.first_panel.push_back(static_cast<std::uint32_t>(to.plane.size()));
    }
    if (k + 1 < patches.size()) out.border.push_back(to.size() - 1);
    slices += last_slice + 1;
  }
  // Patches of one target agree at their borders but for rounding.
  std::vector<double*> heights, offsets;
  for (double& z : to.z) heights.push_back(&z);
  for (double& x : to.x) offsets.push_back(&x);
  unify_places(heights);
  unify_places(offsets);
  return out;
}

Strips only_connectors_of(Strips strips, std::int32_t first, std::int32_t end) {
  for (std::size_t s = 0; s < strips.size(); ++s)
    if (strips.kind[s] == StripKind::Connector &&
        (strips.slice[s] < first || strips.slice[s] >= end))
      strips.kind[s] = StripKind::Bridge;
  return strips;
}

}  // namespace popcut
