// SPDX-License-Identifier: MIT
#include "core/design/strips/same_place.hpp"

#include <algorithm>

namespace popcut {

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
