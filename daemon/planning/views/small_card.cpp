// SPDX-License-Identifier: MIT
#include "daemon/planning/views/small_card.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include <fmt/format.h>

#include "core/picture/deployed_svg.hpp"
#include "core/text/svg_document.hpp"

namespace popcut::planning {
namespace {

constexpr std::size_t kPictureBytes = 60'000;
constexpr std::size_t kMostSmallPanels = 800, kFewestSmallPanels = 12;
constexpr double kWidth_px = 480;

/// The parts side by side, each with so many panels at most, larger ones thinned.
std::string deployed_with(const std::vector<const Pattern*>& parts, std::size_t most_panels) {
  std::vector<std::string> pictures;
  double x = 0, height = 0;
  std::string inside;
  for (const Pattern* part : parts) {
    const CardScene scene = card_scene(*part, {.most_panels = most_panels / parts.size()});
    View view;
    view.width_px = kWidth_px / static_cast<double>(parts.size());
    const auto size = deployed_size_px(scene, part->design_psi_rad, view);
    std::ostringstream out;
    write_deployed_svg(scene, part->design_psi_rad, view, out);
    std::string svg = std::move(out).str();
    if (parts.size() == 1) return svg;
    // An SVG inside another one stands where its x says, and has no line before it.
    const std::size_t begin = svg.find("<svg ");
    inside += fmt::format("<svg x=\"{:.0f}\" ", x) + svg.substr(begin + 5);
    x += std::ceil(size[0]);
    height = std::max(height, std::ceil(size[1]));
  }
  return svg_head(
             fmt::format("width=\"{0:.0f}\" height=\"{1:.0f}\" viewBox=\"0 0 {0:.0f} {1:.0f}\"", x,
                         height),
             {}, SvgPlace::Inside) +
         inside + "</svg>\n";
}

}  // namespace

std::string small_card_svg(const std::vector<const Pattern*>& parts) {
  for (std::size_t panels = kMostSmallPanels;; panels /= 2) {
    std::string svg = deployed_with(parts, std::max(panels, parts.size()));
    if (svg.size() <= kPictureBytes || panels <= kFewestSmallPanels) return svg;
  }
}

}  // namespace popcut::planning
