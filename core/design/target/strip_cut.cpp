// SPDX-License-Identifier: MIT
#include "core/design/target/strip_cut.hpp"

#include <algorithm>
#include <utility>

namespace popcut {

Result<StripCut> cut_strip(const Surface& surface, double s_mm, double width_mm, double least_mm) {
  constexpr int kPlaces = 64;
  const auto is_enough = [&](const Result<SurfaceSlice>& cut) {
    return cut && std::min(cut->curve.h(), cut->curve.d()) >= least_mm;
  };
  auto at_middle = surface.cut(s_mm);
  if (is_enough(at_middle)) return StripCut{std::move(*at_middle), s_mm};
  if (at_middle || is_nothing_there(at_middle.error())) {
    const auto place = [&](int k) { return s_mm + width_mm * ((k + 0.5) / kPlaces - 0.5); };
    int best = 0, longest = 0;
    for (int k = 0, run = 0; k < kPlaces; ++k) {
      run = is_enough(surface.cut(place(k))) ? run + 1 : 0;
      if (run > longest) longest = run, best = k;
    }
    if (longest > 0) {
      const double middle = place(best - (longest - 1) / 2);
      if (auto cut = surface.cut(middle)) return StripCut{std::move(*cut), middle};
    }
  }
  if (!at_middle) return tl::unexpected(at_middle.error());
  return StripCut{std::move(*at_middle), s_mm};
}

}  // namespace popcut
