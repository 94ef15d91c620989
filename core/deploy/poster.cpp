// SPDX-License-Identifier: MIT
#include "core/deploy/poster.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "core/deploy/sheet_mesh.hpp"
#include "core/formats/write/deployed_svg.hpp"
#include "core/text/svg_document.hpp"

namespace popcut {
namespace {

constexpr double kLabelPx = 34;
constexpr std::size_t kMostPoses = 100;

/// All poses at one scale: the widest fills a cell.
struct Cells {
  View view;
  std::vector<std::array<double, 2>> size;  ///< one a pose
  double width{}, height{};                 ///< of the largest
};

Result<void> check(const Pattern& pattern, std::span<const double> psi_rad) {
  constexpr std::size_t kMostDrawn = 2'000'000;
  if (border_crossings(pattern) > kMostDrawn)
    return fail(ErrorKind::OutOfRange, "picture", "the pattern has too many panels to be drawn");
  if (psi_rad.empty() || psi_rad.size() > kMostPoses) {
    return fail(ErrorKind::OutOfRange, "poses",
                fmt::format("{} poses; give 1 to {}", psi_rad.size(), kMostPoses));
  }
  for (std::size_t i = 0; i < psi_rad.size(); ++i) {
    if (!(psi_rad[i] > 0 && psi_rad[i] <= std::numbers::pi)) {
      return fail(ErrorKind::OutOfRange, fmt::format("pose {}", i),
                  fmt::format("{} rad cannot be drawn; give an angle above 0 (shut) up to pi "
                              "(flat)",
                              psi_rad[i]));
    }
  }
  return {};
}

Cells cells_of(const Pattern& pattern, std::span<const double> psi_rad,
               const PosterOptions& options) {
  Cells cells;
  const auto measure = [&](double px_per_mm) {
    cells.view.px_per_mm = px_per_mm;
    cells.size.clear();
    cells.width = cells.height = 0;
    for (const double psi : psi_rad) {
      cells.size.push_back(deployed_size_px(pattern, psi, cells.view));
      cells.width = std::max(cells.width, cells.size.back()[0]);
      cells.height = std::max(cells.height, cells.size.back()[1]);
    }
    return cells.width;
  };
  // The width grows evenly with the scale, from the margins that a picture has.
  const double one = measure(1), two = measure(2);
  const double a_px_per_mm = two - one;
  if (a_px_per_mm > 0) measure(std::max(0.0, options.cell_px - (one - a_px_per_mm)) / a_px_per_mm);
  cells.width = std::ceil(cells.width);
  cells.height = std::ceil(cells.height);
  return cells;
}

std::string head(const Pattern& pattern, double width, double height) {
  width = std::ceil(width);
  height = std::ceil(height);
  return svg_head(
             fmt::format("width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\"", width, height),
             pattern.name, SvgPlace::Inside) +
         fmt::format("<rect width=\"{}\" height=\"{}\" fill=\"#ffffff\"/>\n", width, height);
}

/// One pose standing on the floor of its cell, in the middle.
void put_pose(const Pattern& pattern, const Cells& cells, std::size_t i, double psi_rad,
              const std::array<double, 2>& corner, std::ostream& out) {
  out << fmt::format("<g transform=\"translate({:.2f} {:.2f})\">\n",
                     corner[0] + (cells.width - cells.size[i][0]) / 2,
                     corner[1] + (cells.height - cells.size[i][1]) / 2);
  write_deployed_svg(pattern, psi_rad, cells.view, out);
  out << "</g>\n";
}

std::string label(double x, double y, double psi_rad) {
  const double degrees = psi_rad * 180 / std::numbers::pi;
  const char* const which = degrees >= 180 ? " (flat)" : "";
  return fmt::format(
      "<text x=\"{:.2f}\" y=\"{:.2f}\" text-anchor=\"middle\" font-family=\""
      "sans-serif\" font-size=\"15\" fill=\"#3d3a36\">\u03c8 = {:.0f}\u00b0{}"
      "</text>\n",
      x, y, degrees, which);
}

}  // namespace

Result<void> write_poster_svg(const Pattern& pattern, std::span<const double> psi_rad,
                              const PosterOptions& options, std::ostream& out) {
  if (auto sound = check(pattern, psi_rad); !sound) return sound;
  const Cells cells = cells_of(pattern, psi_rad, options);
  const auto columns =
      std::min(static_cast<std::size_t>(std::max(1, options.columns)), psi_rad.size());
  const std::size_t rows = (psi_rad.size() + columns - 1) / columns;
  const double step_y = cells.height + kLabelPx;
  out << head(pattern, cells.width * static_cast<double>(columns),
              step_y * static_cast<double>(rows));
  for (std::size_t i = 0; i < psi_rad.size(); ++i) {
    const double x = cells.width * static_cast<double>(i % columns);
    const double y = step_y * static_cast<double>(i / columns);
    put_pose(pattern, cells, i, psi_rad[i], {x, y}, out);
    out << label(x + cells.width / 2, y + cells.height + kLabelPx / 2, psi_rad[i]);
  }
  out << "</svg>\n";
  return {};
}

Result<void> write_film_svg(const Pattern& pattern, std::span<const double> psi_rad, double seconds,
                            const PosterOptions& options, std::ostream& out) {
  if (auto sound = check(pattern, psi_rad); !sound) return sound;
  const Cells cells = cells_of(pattern, psi_rad, options);
  out << head(pattern, cells.width, cells.height + kLabelPx);
  // There and back: pose i stands in step i and in step 2n - 2 - i of 2n - 2.
  const std::size_t n = psi_rad.size();
  const std::size_t steps = std::max<std::size_t>(1, 2 * n - 2);
  for (std::size_t i = 0; i < n; ++i) {
    std::string values;
    for (std::size_t k = 0; k < steps; ++k)
      values +=
          fmt::format("{}{}", k == 0 ? "" : ";", k == i || steps - k == i ? "inline" : "none");
    out << fmt::format("<g display=\"{}\">", i + 1 == n ? "inline" : "none");
    if (n > 1)
      out << fmt::format(
          "<animate attributeName=\"display\" calcMode=\"discrete\" dur=\"{}s\" "
          "repeatCount=\"indefinite\" values=\"{}\"/>\n",
          seconds, values);
    put_pose(pattern, cells, i, psi_rad[i], {0, 0}, out);
    out << label(cells.width / 2, cells.height + kLabelPx / 2, psi_rad[i]) << "</g>\n";
  }
  out << "</svg>\n";
  return {};
}

}  // namespace popcut
