// SPDX-License-Identifier: MIT
// Part of device/sim/trace.hpp.
#include <algorithm>
#include <iterator>
#include <map>

#include <fmt/format.h>

#include "core/text/svg_document.hpp"
#include "core/text/text_sink.hpp"
#include "device/sim/trace.hpp"

namespace popcut {
namespace {

constexpr double kMarginMm = 5;
constexpr double kLegendRowMm = 5;

/// Names come from users' tables: markup in them is only text.
/// Strokes that look alike: one tool and one force.
struct Look {
  int tool{};
  double force_steps{};
  double force_gf{};
  friend auto operator<=>(const Look&, const Look&) = default;
};

struct Drawn {
  double mm{};
  std::string path;
};

void put_path(std::string& path, std::span<const PagePoint> points) {
  auto out = std::back_inserter(path);
  for (std::size_t i = 0; i < points.size(); ++i)
    fmt::format_to(out, "{}{:.7g},{:.7g}", i == 0 ? "M" : "L", points[i].x, points[i].y);
  if (points.size() == 1) path += "h0";
}

/// From blue for the lightest force used to red for the heaviest, so that no two look the same.
std::string colour(std::size_t rank, std::size_t count) {
  const double t = count < 2 ? 1.0 : static_cast<double>(rank) / static_cast<double>(count - 1);
  const auto channel = [](double value) { return static_cast<int>(value * 255 + 0.5); };
  return fmt::format("#{:02x}{:02x}{:02x}", channel(0.1 + 0.75 * t),
                     channel(0.45 * (1 - t) + 0.1 * t), channel(0.85 * (1 - t) + 0.1 * t));
}

std::string travel_path(const Trace& trace) {
  std::string path;
  PagePoint at{};
  for (const TraceStroke& stroke : trace.strokes) {
    const auto points = trace.points_of(stroke);
    if (points.empty()) continue;
    const PagePoint way[] = {at, points.front()};
    put_path(path, way);
    at = points.back();
  }
  return path;
}

Box page_box(const Trace& trace) {
  Box box;
  box.add({0, 0});
  for (const PagePoint& point : trace.points) box.add(point);
  // A roll is shown as far as it is cut, a sheet whole.
  const bool roll = trace.page_length_mm > 1000;
  box.add({trace.page_width_mm, roll ? box.y1 : trace.page_length_mm});
  return box;
}

std::string legend_words(const Look& look, double mm) {
  std::string force = "force not set";
  if (look.force_gf > 0)
    force = fmt::format("{:.4g} gf (step {:.4g})", look.force_gf, look.force_steps);
  else if (look.force_steps > 0)
    force = fmt::format("force {:.4g}", look.force_steps);
  return fmt::format("tool {}, {}: {:.1f} mm", look.tool, force, mm);
}

}  // namespace

std::string trace_svg(const Trace& trace) {
  std::map<Look, Drawn> looks;
  for (const TraceStroke& stroke : trace.strokes) {
    const auto points = trace.points_of(stroke);
    Drawn& drawn = looks[{stroke.tool, stroke.force_steps, stroke.force_gf}];
    put_path(drawn.path, points);
    for (std::size_t i = 1; i < points.size(); ++i) drawn.mm += distance(points[i - 1], points[i]);
  }
  const Box box = page_box(trace);
  const std::size_t rows = looks.size() + (trace.clipped_mm > 0 ? 4u : 3u);
  const double width = std::max(box.x1 - box.x0, 90.0) + 2 * kMarginMm;
  const double height = box.y1 - box.y0 + 2 * kMarginMm + kLegendRowMm * static_cast<double>(rows);
  std::string svg = svg_head(fmt::format("width=\"{2:.6g}mm\" height=\"{3:.6g}mm\" "
                                         "viewBox=\"{0:.6g} {1:.6g} {2:.6g} {3:.6g}\"",
                                         box.x0 - kMarginMm, box.y0 - kMarginMm, width, height),
                             fmt::format("What {} did", trace.machine));
  svg += fmt::format(
      "<rect x=\"{:.6g}\" y=\"{:.6g}\" width=\"{:.6g}\" height=\"{:.6g}\" fill=\"#fff\"/>\n"
      "<rect x=\"0\" y=\"0\" width=\"{:.6g}\" height=\"{:.6g}\" fill=\"none\" "
      "stroke=\"#bbb\" stroke-width=\"0.2\"/>\n",
      box.x0 - kMarginMm, box.y0 - kMarginMm, width, height, trace.page_width_mm,
      trace.page_length_mm > 1000 ? box.y1 : trace.page_length_mm);
  auto out = std::back_inserter(svg);
  fmt::format_to(out,
                 "<path class=\"travel\" d=\"{}\" fill=\"none\" stroke=\"#3a9\" "
                 "stroke-width=\"0.05\"/>\n",
                 travel_path(trace));
  const double legend_x = box.x0;
  double y = box.y1 + kMarginMm + kLegendRowMm;
  const auto legend_row = [&](const std::string& stroke, double line_mm, const std::string& words) {
    fmt::format_to(out,
                   "<path d=\"M{0:.6g},{1:.6g}h10\" stroke=\"{2}\" stroke-width=\"{3}\"/>"
                   "<text x=\"{4:.6g}\" y=\"{5:.6g}\" font-family=\"sans-serif\" "
                   "font-size=\"3.5\">{6}</text>\n",
                   legend_x, y - 1.2, stroke, line_mm, legend_x + 12, y, words);
    y += kLegendRowMm;
  };
  std::size_t rank = 0;
  for (const auto& [look, drawn] : looks) {
    const std::string stroke = colour(rank++, looks.size());
    fmt::format_to(out,
                   "<path class=\"cut\" d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"0.25\" "
                   "stroke-linecap=\"round\"/>\n",
                   drawn.path, stroke);
    legend_row(stroke, 0.5, legend_words(look, drawn.mm));
  }
  if (trace.clipped_mm > 0) {
    std::string grey;
    for (std::size_t i = 0; i + 1 < trace.clipped.size(); i += 2)
      put_path(grey, std::span(trace.clipped).subspan(i, 2));
    // White first, to hide the colour of the force where nothing was cut.
    fmt::format_to(out,
                   "<path d=\"{0}\" fill=\"none\" stroke=\"#fff\" stroke-width=\"0.8\"/>\n"
                   "<path class=\"clipped\" d=\"{0}\" fill=\"none\" stroke=\"#aaa\" "
                   "stroke-width=\"0.35\"/>\n",
                   grey);
    legend_row("#aaa", 0.5,
               fmt::format("outside the window, not cut: {:.1f} mm", trace.clipped_mm));
  }
  legend_row("#3a9", 0.05, fmt::format("travel with the tool up: {:.1f} mm", trace.travel_mm));
  legend_row("none", 0,
             fmt::format("{}: {:.1f} mm in {} strokes, {:.0f} s", xml_escaped(trace.machine),
                         trace.cut_mm, trace.lifts, trace.seconds));
  return svg + "</svg>\n";
}

}  // namespace popcut
