// SPDX-License-Identifier: MIT
#include "core/design/chain/fit_report.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace popcut {

void add_fit(DesignReport& report, FitMode mode) {
  report.fit_nearest = mode == FitMode::Nearest;
  report.fit = {};
  double spread = 0.0;
  std::size_t worst = 0, several = 0, widest = 0;
  for (std::size_t j = 0; j < report.slices.size(); ++j) {
    const SliceReport& slice = report.slices[j];
    accumulate(report.fit, slice.fit);
    if (slice.fit.max_mm > report.slices[worst].fit.max_mm) worst = j;
    several += slice.minima > 1 ? 1 : 0;
    if (slice.spread > spread) spread = slice.spread, widest = j;
  }
  if (report.fit.unreachable_mm > 0.0)
    report.notes.push_back(fmt::format(
        "{:.3g} % of the target's outline is out of reach of falling curves; the seen part is "
        "followed to {:.3g} mm rms, {:.3g} mm at most (slice {})",
        100.0 * unreachable_share(report.fit), report.fit.rms_mm, report.fit.max_mm, worst));
  if (several > 0)
    report.notes.push_back(
        fmt::format("the chains of {} slices have several minima; the best of {} starts is taken, "
                    "the worst is {:.3g} % above it (slice {})",
                    several, 25, 100.0 * spread, widest));
}

}  // namespace popcut
