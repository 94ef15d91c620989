// SPDX-License-Identifier: MIT
#include "core/design/chain/adaptive_widths.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace popcut {
namespace {

/// Largest distance of the curves between two places from the straight line between the curves
/// there, mm, looked at a quarter, a half and three quarters of the way.
Result<double> bulge(const Surface& surface, double from_mm, double to_mm) {
  const auto a = surface.slice(from_mm), b = surface.slice(to_mm);
  for (const auto* curve : {&a, &b})
    if (!*curve) return tl::unexpected(curve->error());
  constexpr int kSamples = 16;
  double most = 0.0;
  for (const double share : {0.25, 0.5, 0.75}) {
    const auto m = surface.slice(from_mm + share * (to_mm - from_mm));
    if (!m) return tl::unexpected(m.error());
    for (int i = 0; i <= kSamples; ++i) {
      const double t = -1.0 + 2.0 * i / kSamples;
      const CurveJet p = a->at(t), q = m->at(t), r = b->at(t);
      most = std::max(most, std::hypot(q.x - (1.0 - share) * p.x - share * r.x,
                                       q.z - (1.0 - share) * p.z - share * r.z));
    }
  }
  return most;
}

/// One pass from slice 0 outward; `error_mm` may be tighter than what was asked for.
Result<ChosenWidths> walk(const Surface& surface, const AdaptiveWidths& adaptive, double error,
                          int most_slices, double least) {
  // Distance from slice to slice is (w_j + w_(j+1))/2, so a width follows from the pitch to it.
  const auto fits = [&](double s, double pitch) {
    const auto b = bulge(surface, s, s + pitch);
    return b && *b <= error;
  };
  const auto longest = [&](double s, double low, double high) {
    if (fits(s, high)) return high;
    for (int k = 0; k < 40; ++k) {
      const double middle = 0.5 * (low + high);
      (fits(s, middle) ? low : high) = middle;
    }
    return low;
  };
  if (!fits(0.0, least)) {
    const auto b = bulge(surface, 0.0, least);
    if (!b) return tl::unexpected(b.error());
    return fail(
        ErrorKind::Infeasible, "/widths_mm/max_error_mm",
        fmt::format("is {:g} mm; even slices of {:g} mm (4 min_panel_mm) are off by {:.3g} mm",
                    error, least, *b));
  }
  const double size = surface.slice(0.0)->h();
  ChosenWidths out;
  double s = 0.0, narrowest = longest(0.0, least, size);
  out.widths_mm.push_back(narrowest);
  while (static_cast<int>(out.widths_mm.size()) < most_slices) {
    const double w = out.widths_mm.back();
    if (adaptive.length_mm && s + 0.5 * w >= *adaptive.length_mm) break;
    const double low = 0.5 * (w + std::max(least, 0.5 * w)),
                 high = std::max(low, std::min(1.5 * w, size));
    double pitch = longest(s, low, high);
    if (!fits(s, pitch)) {
      // The last width was too bold for what follows: take it back by half, down to the thinnest.
      if (w <= least * 1.0001)
        return fail(
            ErrorKind::Infeasible, "/widths_mm/max_error_mm",
            fmt::format("is {:g} mm; at s = {:.6g} mm even slices of {:g} mm are farther off",
                        error, s, least));
      out.widths_mm.back() = std::max(least, 0.5 * w);
      if (out.widths_mm.size() > 1) s -= 0.5 * (w - out.widths_mm.back());
      continue;
    }
    narrowest = std::min(narrowest, pitch);
    out.widths_mm.push_back(2.0 * pitch - w);
    s += pitch;
  }
  const double length = s + 0.5 * out.widths_mm.back();
  if (adaptive.length_mm && length < *adaptive.length_mm)
    return fail(ErrorKind::Infeasible, "/slices",
                fmt::format("{} slices reach {:.4g} of {:g} mm at that error; more slices, or a "
                            "larger max_error_mm",
                            most_slices, length, *adaptive.length_mm));
  out.uniform_slices = std::max(static_cast<int>(std::ceil(length / narrowest)),
                                static_cast<int>(out.widths_mm.size()));
  return out;
}

/// Whether every pitch keeps to the error: a pitch is made shorter when its neighbour needs it, and
/// a shorter one may bulge more where the target waves.
bool keeps(const Surface& surface, const ChosenWidths& chosen, double error) {
  double s = 0.0;
  for (std::size_t j = 1; j < chosen.widths_mm.size(); ++j) {
    const double pitch = 0.5 * (chosen.widths_mm[j - 1] + chosen.widths_mm[j]);
    const auto b = bulge(surface, s, s + pitch);
    if (!b || *b > error) return false;
    s += pitch;
  }
  return true;
}

}  // namespace

Result<ChosenWidths> choose_widths(const Surface& surface, const AdaptiveWidths& adaptive,
                                   int most_slices, double min_panel_mm) {
  double error = adaptive.max_error_mm;
  Result<ChosenWidths> chosen = fail(ErrorKind::Internal, "", "");
  for (int round = 0; round < 20; ++round, error *= 0.8) {
    chosen = walk(surface, adaptive, error, most_slices, 4.0 * min_panel_mm);
    if (!chosen || keeps(surface, *chosen, adaptive.max_error_mm)) return chosen;
  }
  return fail(
      ErrorKind::Infeasible, "/widths_mm/max_error_mm",
      "the target waves too fast for widths chosen from its curvature; give a list of widths");
}

}  // namespace popcut
