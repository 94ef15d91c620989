// SPDX-License-Identifier: MIT
#include "core/print/fold_guide_pages.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <span>
#include <sstream>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "core/picture/deployed_svg.hpp"
#include "core/print/footer.hpp"
#include "core/print/step_pages.hpp"

namespace popcut {
namespace {

using hands::FoldGuide;
using hands::GuideFold;
using hands::GuideStep;
using hands::LookFrom;
using hands::StepKind;

constexpr std::size_t kMostScenePanels = 4000;
constexpr double kPicturePx = 600;

/// A pattern as a mirror shows it, so that pictures can look from the left.
Pattern mirrored(Pattern pattern) {
  for (PatternVertex& p : pattern.vertices) p.v = pattern.width_mm - p.v;
  for (Kite& kite : pattern.kites) {
    std::swap(kite.v0_mm, kite.v1_mm);
    for (double* const v : {&kite.v0_mm, &kite.v1_mm}) *v = pattern.width_mm - *v;
  }
  for (PatternEdge& e : pattern.edges) std::swap(e.left, e.right);
  for (std::size_t f = 0; f < pattern.faces(); ++f)
    std::reverse(pattern.face_vertices.begin() + pattern.face_first[f],
                 pattern.face_vertices.begin() + pattern.face_first[f + 1]);
  return pattern;
}

/// Draws the steps of one pattern.
class Drawer {
 public:
  Drawer(const Pattern& pattern, const FoldGuide& guide)
      : pattern_(pattern),
        guide_(guide),
        mirror_(mirrored(pattern)),
        right_(card_scene(pattern, {.most_panels = kMostScenePanels})),
        left_(card_scene(mirror_, {.most_panels = kMostScenePanels})) {
    for (const PatternVertex& p : pattern.vertices) sheet_.add(on_page(p));
  }
  Drawer(const Drawer&) = delete;
  Drawer& operator=(const Drawer&) = delete;

  /// A step within a cell of its page: words above, the two pictures side by side below.
  [[nodiscard]] std::string step_svg(std::size_t k, const PageCell& cell) {
    const GuideStep& step = guide_.steps[k];
    PageCell rest;
    std::string svg = step_words_svg(
        k + 1,
        step.panels.empty() || !guide_.stands
            ? step.words
            : fmt::format("{} Seen from the {}.", step.words, name_of(step.look_from)),
        cell, rest);
    if (rest.height <= 5) return svg;
    if (!guide_.stands) return svg + sheet_svg(step, rest);
    const double half = (rest.width - 1.5) / 2;
    svg += standing_svg(step, {rest.x, rest.y, half, rest.height});
    return svg + sheet_svg(step, {rest.x + half + 1.5, rest.y, half, rest.height});
  }

 private:
  [[nodiscard]] PagePoint on_page(const PatternVertex& p) const { return {p.v, pattern_.u(p)}; }

  // 1. The standing card.

  /// The kite that a fold lies on, or none.
  [[nodiscard]] const Kite* kite_of(const GuideFold& fold) const {
    for (const Kite& kite : pattern_.kites)
      for (const std::uint32_t face : kite.faces)
        if (std::find(fold.panels.begin(), fold.panels.end(), face) != fold.panels.end())
          return &kite;
    return nullptr;
  }

  [[nodiscard]] std::string standing_svg(const GuideStep& step, const PageCell& place) {
    const bool is_left = step.look_from == LookFrom::Left;
    CardScene& scene = is_left ? left_ : right_;
    scene.tones.assign(pattern_.faces(), PanelTone::Pale);
    for (const std::uint32_t panel : step.panels) scene.tones[panel] = PanelTone::Lit;
    scene.lines.clear();
    for (const std::uint32_t k : step.folds) {
      const GuideFold& fold = guide_.folds[k];
      SceneLine line{fold.from, fold.to,
                     std::string(fold.is_mountain() ? kMountainInk : kValleyInk), kite_of(fold)};
      for (PatternVertex* p : {&line.from, &line.to})
        if (is_left) p->v = pattern_.width_mm - p->v;
      scene.lines.push_back(std::move(line));
    }
    const View view{.width_px = kPicturePx};
    const double psi_rad = pattern_.design_psi_rad;
    const auto size = deployed_size_px(scene, psi_rad, view);
    if (!(size[0] > 0 && size[1] > 0)) return {};
    const double scale = std::min(place.width / size[0], place.height / size[1]);
    const double x = place.x + (place.width - scale * size[0]) / 2,
                 y = place.y + (place.height - scale * size[1]) / 2;
    std::ostringstream out;
    write_deployed_svg(scene, psi_rad, view, out);
    return fmt::format("<g transform=\"translate({:.3f} {:.3f}) scale({:.5f} {:.5f})\">\n{}</g>\n",
                       is_left ? x + scale * size[0] : x, y, is_left ? -scale : scale, scale,
                       std::move(out).str());
  }

  // 2. The sheet.

  /// The part of the sheet around what a step is about.
  [[nodiscard]] Box window_of(const GuideStep& step) const {
    constexpr double kLeastPart = 0.35, kNearlyAll = 0.75;
    Box near;
    for (const std::uint32_t k : step.folds)
      near.add(on_page(guide_.folds[k].from)), near.add(on_page(guide_.folds[k].to));
    for (const std::uint32_t panel : step.panels)
      for (const std::uint32_t corner : pattern_.face(panel))
        near.add(on_page(pattern_.vertices[corner]));
    if (step.kind == StepKind::Waste || near.x1 < near.x0) return sheet_;
    const double side = std::max(sheet_.width(), sheet_.height());
    const double wanted = std::max({kLeastPart * side, 1.2 * near.width(), 1.2 * near.height()});
    if (wanted > kNearlyAll * side) return sheet_;
    const auto placed = [&](double low, double high, double from, double to) {
      const double width = std::min(wanted, to - from);
      const double begin = std::clamp((low + high - width) / 2, from, to - width);
      return std::pair(begin, begin + width);
    };
    const auto [x0, x1] = placed(near.x0, near.x1, sheet_.x0, sheet_.x1);
    const auto [y0, y1] = placed(near.y0, near.y1, sheet_.y0, sheet_.y1);
    return {x0, y0, x1, y1};
  }

  void put_line(std::string& svg, PagePoint a, PagePoint b, const Box& window) const {
    if (std::max(a.x, b.x) < window.x0 || std::min(a.x, b.x) > window.x1 ||
        std::max(a.y, b.y) < window.y0 || std::min(a.y, b.y) > window.y1)
      return;
    fmt::format_to(std::back_inserter(svg), "M{:.2f} {:.2f}L{:.2f} {:.2f}", a.x, a.y, b.x, b.y);
  }

  void put_area(std::string& svg, std::span<const std::uint32_t> corners) const {
    char command = 'M';
    for (const std::uint32_t corner : corners) {
      const PagePoint p = on_page(pattern_.vertices[corner]);
      fmt::format_to(std::back_inserter(svg), "{}{:.2f} {:.2f}", std::exchange(command, 'L'), p.x,
                     p.y);
    }
    svg += 'Z';
  }

  [[nodiscard]] std::string sheet_svg(const GuideStep& step, const PageCell& place) const {
    const Box window = window_of(step);
    if (!(window.width() > 0 && window.height() > 0)) return {};
    const double scale = std::min(place.width / window.width(), place.height / window.height());
    const double width = scale * window.width(), height = scale * window.height();
    const double mm = 1 / scale;  // of the page, on the sheet
    const auto path = [&](std::string_view d, std::string_view look) {
      return d.empty() ? std::string() : fmt::format("<path d=\"{}\" {}/>\n", d, look);
    };
    std::string cuts, folds, lit, waste, svg;
    for (const PatternEdge& e : pattern_.edges) {
      const bool is_cut = e.role == EdgeRole::Slit || e.role == EdgeRole::Outline;
      put_line(is_cut ? cuts : folds, on_page(pattern_.vertices[e.from]),
               on_page(pattern_.vertices[e.to]), window);
    }
    for (const std::uint32_t panel : step.panels) put_area(lit, pattern_.face(panel));
    for (const auto& piece : guide_.waste) put_area(waste, piece);
    svg = fmt::format(
        "<svg x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\" viewBox=\"{:.3f} {:.3f} "
        "{:.3f} {:.3f}\">\n",
        place.x + (place.width - width) / 2, place.y + (place.height - height) / 2, width, height,
        window.x0, window.y0, window.width(), window.height());
    svg += path(lit, "fill=\"#ffe2a0\"");
    svg += path(waste, step.kind == StepKind::Waste ? "fill=\"#9a9a9a\"" : "fill=\"#e8e8e8\"");
    svg += path(folds, fmt::format("fill=\"none\" stroke=\"#b4b4b4\" stroke-width=\"{0:.3f}\" "
                                   "stroke-dasharray=\"{1:.3f} {1:.3f}\"",
                                   0.1 * mm, 0.5 * mm));
    svg += path(cuts,
                fmt::format("fill=\"none\" stroke=\"#404040\" stroke-width=\"{:.3f}\"", 0.12 * mm));
    for (const std::uint32_t k : step.folds) svg += fold_svg(guide_.folds[k], mm);
    svg += "</svg>\n";
    if (window.width() < sheet_.width() || window.height() < sheet_.height())
      svg += map_svg(window, {place.x + place.width - 11, place.y, 11, 11});
    return svg;
  }

  /// A fold of the step: wide, in the colour and the dashes of the legend.
  [[nodiscard]] std::string fold_svg(const GuideFold& fold, double mm) const {
    const PagePoint a = on_page(fold.from), b = on_page(fold.to);
    const double long_mm = std::hypot(b.x - a.x, b.y - a.y);
    const Operation operation =
        fold.is_mountain() ? Operation::FoldMountain : Operation::FoldValley;
    constexpr double kWider = 2.4;  // than lines of pages
    std::string dashes;
    for (const double part : fold_dashes_mm(operation, long_mm / mm * kWider))
      dashes += fmt::format("{:.3f} ", part * mm / kWider);
    return fmt::format(
        "<path d=\"M{:.2f} {:.2f}L{:.2f} {:.2f}\" fill=\"none\" stroke=\"{}\" "
        "stroke-width=\"{:.3f}\" stroke-dasharray=\"{}\"/>\n",
        a.x, a.y, b.x, b.y, fold.is_mountain() ? kMountainInk : kValleyInk, 0.7 * mm, dashes);
  }

  /// Where on the sheet a window lies.
  [[nodiscard]] std::string map_svg(const Box& window, const PageCell& place) const {
    const double scale = std::min(place.width / sheet_.width(), place.height / sheet_.height());
    const auto box = [&](const Box& b, std::string_view look) {
      return fmt::format(
          "<rect x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\" {}/>\n",
          place.x + place.width - scale * (sheet_.x1 - b.x0), place.y + scale * (b.y0 - sheet_.y0),
          scale * b.width(), scale * b.height(), look);
    };
    return box(sheet_, "fill=\"#ffffff\" stroke=\"#606060\" stroke-width=\"0.15\"") +
           box(window, "fill=\"#ffbe3c\" stroke=\"#606060\" stroke-width=\"0.1\"");
  }

  const Pattern& pattern_;
  const FoldGuide& guide_;
  Pattern mirror_;
  CardScene right_, left_;
  Box sheet_;  ///< x = v, y = u
};

}  // namespace

Result<std::vector<PrintedPage>> fold_guide_pages(const Pattern& pattern, const FoldGuide& guide,
                                                  std::array<double, 2> page_mm) {
  const std::size_t pages =
      std::max<std::size_t>(1, (guide.folds.size() + kFoldsAPage - 1) / kFoldsAPage);
  const std::size_t steps_a_page = (guide.steps.size() + pages - 1) / pages;
  Drawer drawer(pattern, guide);
  return step_pages("How to fold " + page_name(pattern.name), page_mm, guide.steps.size(),
                    steps_a_page, [&](std::size_t k, const PageCell& cell) -> Result<std::string> {
                      return drawer.step_svg(k, cell);
                    });
}

}  // namespace popcut
