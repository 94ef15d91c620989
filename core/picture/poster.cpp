// SPDX-License-Identifier: MIT
#include "core/picture/poster.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "core/geometry/angle.hpp"
#include "core/picture/picture_words.hpp"
#include "core/text/svg_document.hpp"

namespace popcut {
namespace {

constexpr double kLabelPx = 34, kFootPx = 82;
constexpr std::size_t kMostPoses = 100;

/// All poses at one scale: the widest fills a cell.
struct Cells {
  double px_per_mm{};
  bool all_bars{};                          ///< else only the last one has a bar
  std::vector<std::array<double, 2>> size;  ///< one a pose
  double width{}, height{};                 ///< of the largest

  [[nodiscard]] View view(std::size_t i, std::size_t poses) const {
    const bool has_bar = all_bars || i + 1 == poses;
    return {.px_per_mm = px_per_mm, .labels = has_bar ? Labels::Bar : Labels::None};
  }
};

Result<void> check(std::span<const double> psi_rad) {
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

Cells cells_of(const CardScene& scene, std::span<const double> psi_rad,
               const PosterOptions& options, bool all_bars) {
  Cells cells;
  cells.all_bars = all_bars;
  const auto measure = [&](double px_per_mm) {
    cells.px_per_mm = px_per_mm;
    cells.size.clear();
    cells.width = cells.height = 0;
    for (std::size_t i = 0; i < psi_rad.size(); ++i) {
      cells.size.push_back(deployed_size_px(scene, psi_rad[i], cells.view(i, psi_rad.size())));
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

std::string head(const CardScene& scene, double width, double height) {
  width = std::ceil(width);
  height = std::ceil(height);
  return svg_head(
             fmt::format("width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\"", width, height),
             scene.pattern->name, SvgPlace::Inside) +
         fmt::format("<rect width=\"{}\" height=\"{}\" fill=\"#ffffff\"/>\n", width, height);
}

/// One pose standing on the floor of its cell, in the middle.
void put_pose(const CardScene& scene, const Cells& cells, std::size_t i, double psi_rad,
              const std::array<double, 2>& corner, std::ostream& out) {
  out << fmt::format("<g transform=\"translate({:.2f} {:.2f})\">\n",
                     corner[0] + (cells.width - cells.size[i][0]) / 2,
                     corner[1] + (cells.height - cells.size[i][1]) / 2);
  write_deployed_svg(scene, psi_rad, cells.view(i, cells.size.size()), out);
  out << "</g>\n";
}

std::string label(double x, double y, double psi_rad) {
  const double psi_deg = degrees(psi_rad);
  return picture_text(
      x, y, fmt::format("\u03c8 = {:.0f}\u00b0{}", psi_deg, psi_deg >= 180 ? " (flat)" : ""),
      "middle", {.size = 15});
}

/// Whose poster it is, and how large the card is.
std::string foot(const CardScene& scene, std::span<const double> psi_rad, double width, double y) {
  const Pattern& pattern = *scene.pattern;
  std::string words = pattern.card ? card_in_words(pattern) : std::string("without a card");
  const auto has_ghost = [&](double psi) { return is_shown_at(scene, psi); };
  if (std::any_of(psi_rad.begin(), psi_rad.end(), has_ghost))
    words += "; blue: the shape asked for";
  return picture_text(16, y + 20, pattern.name, "start", {.size = 17}) +
         picture_text(16, y + 44, words, "start") +
         picture_text(16, y + 64, thinned_in_words(scene), "start") +
         error_legend(scene, width - 216, y + 2);
}

}  // namespace

Result<void> write_poster_svg(const Pattern& pattern, std::span<const double> psi_rad,
                              const PosterOptions& options, std::ostream& out) {
  if (auto sound = check(psi_rad); !sound) return sound;
  const CardScene scene = card_scene(pattern, options.scene);
  Cells cells = cells_of(scene, psi_rad, options, false);
  const auto columns =
      std::min(static_cast<std::size_t>(std::max(1, options.columns)), psi_rad.size());
  const std::size_t rows = (psi_rad.size() + columns - 1) / columns;
  const double step_y = cells.height + kLabelPx;
  const double width = cells.width * static_cast<double>(columns);
  out << head(scene, width, step_y * static_cast<double>(rows) + kFootPx);
  for (std::size_t i = 0; i < psi_rad.size(); ++i) {
    const double x = cells.width * static_cast<double>(i % columns);
    const double y = step_y * static_cast<double>(i / columns);
    put_pose(scene, cells, i, psi_rad[i], {x, y}, out);
    out << label(x + cells.width / 2, y + cells.height + kLabelPx / 2, psi_rad[i]);
  }
  out << foot(scene, psi_rad, width, step_y * static_cast<double>(rows)) << "</svg>\n";
  return {};
}

Result<void> write_film_svg(const Pattern& pattern, std::span<const double> psi_rad, double seconds,
                            const PosterOptions& options, std::ostream& out) {
  if (auto sound = check(psi_rad); !sound) return sound;
  const CardScene scene = card_scene(pattern, options.scene);
  Cells cells = cells_of(scene, psi_rad, options, true);
  out << head(scene, cells.width, cells.height + kLabelPx);
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
    put_pose(scene, cells, i, psi_rad[i], {0, 0}, out);
    out << label(cells.width / 2, cells.height + kLabelPx / 2, psi_rad[i]) << "</g>\n";
  }
  out << "</svg>\n";
  return {};
}

}  // namespace popcut
