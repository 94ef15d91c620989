// SPDX-License-Identifier: MIT
#include "core/design/strips/strips.hpp"

#include <algorithm>

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

}  // namespace popcut
