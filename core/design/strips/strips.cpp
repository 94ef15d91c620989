// SPDX-License-Identifier: MIT
#include "core/design/strips/strips.hpp"

#include <algorithm>

#include "core/geometry/disjoint_sets.hpp"

namespace popcut {

StripWriter::StripWriter() {
  strips_.v_begin.push_back(0.0);
  strips_.first_panel.push_back(0);
}

void StripWriter::start(double x, double z) {
  strips_.x.push_back(x);
  strips_.z.push_back(z);
}

void StripWriter::panel_to(double x, double z, PlaneId plane, int level) {
  strips_.plane.push_back(plane);
  strips_.level.push_back(level);
  start(x, z);
}

void StripWriter::close(StripKind kind, std::int32_t slice, double width_mm) {
  strips_.kind.push_back(kind);
  strips_.slice.push_back(slice);
  strips_.v_begin.push_back(strips_.v_begin.back() + width_mm);
  strips_.first_panel.push_back(static_cast<std::uint32_t>(strips_.plane.size()));
}

void StripWriter::copy(const Strips& from, std::size_t s) {
  start(from.x[from.first_point(s)], from.z[from.first_point(s)]);
  for (std::uint32_t p = from.first_panel[s]; p < from.first_panel[s + 1]; ++p)
    panel_to(from.x[p + s + 1], from.z[p + s + 1], from.plane[p], from.level[p]);
  close(from.kind[s], from.slice[s], from.v_begin[s + 1] - from.v_begin[s]);
}

void unify_places(std::vector<double*>& places) {
  std::erase_if(places, [](const double* place) { return !(*place > kSamePlace_mm); });
  std::sort(places.begin(), places.end(), [](const double* a, const double* b) { return *a < *b; });
  double least = 0.0;
  for (double* const place : places) {
    if (*place - least >= kSamePlace_mm) least = *place;
    *place = least;
  }
}

void unify_planes(Strips& strips) {
  if (strips.panels() == 0) return;
  DisjointSets same(
      static_cast<std::size_t>(*std::max_element(strips.plane.begin(), strips.plane.end())) + 1);
  const auto is_upright = [&](std::size_t point) { return strips.x[point] == strips.x[point + 1]; };
  bool any = false;
  // Two pointers along both staircases, in the order of the distance from the wall's top: where two
  // panels lie in one plane and overlap, their stretches of it do.
  for (std::size_t s = 0; s + 1 < strips.size(); ++s) {
    std::uint32_t p = strips.first_panel[s], q = strips.first_panel[s + 1];
    const std::uint32_t p_end = q, q_end = strips.first_panel[s + 2];
    while (p < p_end && q < q_end) {
      const std::size_t i = p + s, j = q + s + 1;  // first points of the panels
      const bool upright = is_upright(i);
      if (strips.plane[p] != strips.plane[q] && upright == is_upright(j) &&
          (upright ? strips.x[i] == strips.x[j] : strips.z[i] == strips.z[j])) {
        any = true;
        same.join(static_cast<std::uint32_t>(strips.plane[p]),
                  static_cast<std::uint32_t>(strips.plane[q]));
      }
      const double p_stop = strips.x[i + 1] - strips.z[i + 1];
      const double q_stop = strips.x[j + 1] - strips.z[j + 1];
      if (p_stop <= q_stop) ++p;
      if (q_stop <= p_stop) ++q;
    }
  }
  if (!any) return;
  for (PlaneId& id : strips.plane)
    id = static_cast<PlaneId>(same.find(static_cast<std::uint32_t>(id)));
}

}  // namespace popcut
