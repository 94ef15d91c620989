// SPDX-License-Identifier: MIT
#include "core/design/strips/pattern_join.hpp"

#include <algorithm>

namespace popcut {

JoinedStrips join_strips(std::span<const Strips* const> patches, double wall_mm, double ground_mm) {
  JoinedStrips out;
  StripWriter writer;
  std::size_t strips = 0;
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
      last_slice = std::max(last_slice, from.slice[s]);
      writer.start(from.x[from.first_point(s)], wall_mm);
      for (std::uint32_t p = from.first_panel[s]; p < from.first_panel[s + 1]; ++p) {
        const PlaneId plane = from.plane[p] <= kGroundPlane ? from.plane[p] : from.plane[p] + shift;
        const bool is_last = p + 1 == from.first_panel[s + 1];
        writer.panel_to(is_last ? ground_mm : from.x[p + s + 1], from.z[p + s + 1], plane,
                        from.level[p]);
        planes = std::max(planes, plane + 1);
      }
      writer.close(from.kind[s], from.slice[s] < 0 ? -1 : from.slice[s] + slices,
                   from.v_begin[s + 1] - from.v_begin[s]);
      ++strips;
    }
    if (k + 1 < patches.size()) out.border.push_back(strips - 1);
    slices += last_slice + 1;
  }
  // Patches of one target agree at their borders but for rounding.
  out.strips = writer.take();
  std::vector<double*> heights, offsets;
  for (double& z : out.strips.z) heights.push_back(&z);
  for (double& x : out.strips.x) offsets.push_back(&x);
  unify_places(heights);
  unify_places(offsets);
  unify_planes(out.strips);
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
