// SPDX-License-Identifier: MIT
#include "core/curvature/assembly_plot.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

namespace popcut {

plot::Panel assembly_panel(const AssemblyMaps& maps, bool gaussian, std::string title) {
  const std::vector<double>& value = gaussian ? maps.K : maps.H;
  double most = 0;
  for (const double v : value)
    if (std::isfinite(v)) most = std::max(most, std::abs(v));
  plot::Panel panel;
  panel.title = std::move(title);
  panel.x = {"r", maps.r.from, maps.r.to, false};
  panel.y = {"λ", maps.lambda.from, maps.lambda.to, false};
  panel.map = plot::Map{
      maps.r.count, maps.lambda.count, value, gaussian ? "K" : "H", -most, most, true, {0.0}, {}};
  for (const double level : plot::ticks({"", -most, most, false}))
    if (level != 0) panel.map->thin_contours.push_back(level);
  return panel;
}

std::string assembly_maps_svg(const AssemblyMaps& maps, double phi_rad) {
  const std::string at = fmt::format("(r, λ) at φ = {:.6g} π", phi_rad / std::numbers::pi);
  const std::array<plot::Panel, 2> panels{assembly_panel(maps, true, "K" + at),
                                          assembly_panel(maps, false, "H" + at)};
  return plot::figure_svg(panels);
}

}  // namespace popcut
