// SPDX-License-Identifier: MIT
#include "core/formats/dxf/dxf_dashes.hpp"

#include <cmath>

namespace popcut {

DxfDashes dxf_dashes(std::span<const double> elements) {
  DxfDashes out;
  bool dash = false, gap = false;
  for (const double e : elements) {
    dash = dash || e > 0.0;
    gap = gap || e < 0.0;
    out.period += std::abs(e);
  }
  if (!dash || !gap || !std::isfinite(out.period)) return {};
  double at = elements.back() < 0.0 ? -elements.back() / 2 : 0.0;
  for (const double e : elements) {
    if (e > 0.0) out.dashes.push_back({at / out.period, (at + e) / out.period});
    at += std::abs(e);
  }
  return out;
}

double dxf_periods(double length, double period) {
  return std::max(1.0, std::round(length / period));
}

}  // namespace popcut
