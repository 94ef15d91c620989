// SPDX-License-Identifier: MIT
// Part of device/sim/trace.hpp.
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>

#include <fmt/format.h>

#include "core/drawing/sheet_frame.hpp"
#include "core/text/svg_document.hpp"
#include "core/text/text_sink.hpp"
#include "core/text/text_width.hpp"
#include "device/sim/trace.hpp"

namespace popcut {
namespace {

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
  const auto channel = [](double value) { return static_cast<int>(std::floor(value * 255 + 0.5)); };
  return fmt::format("#{:02x}{:02x}{:02x}", channel(0.1 + 0.75 * t),
                     channel(0.45 * (1 - t) + 0.1 * t), channel(0.85 * (1 - t) + 0.1 * t));
}

std::string travel_path(const Trace& trace) {
  std::string path;
  PagePoint at{};
  for (const TraceStroke& stroke : trace.strokes) {
    const auto points = trace.points_of(stroke);
    if (points.empty()) continue;
    const std::array way{at, points.front()};
    put_path(path, way);
    at = points.back();
  }
  return path;
}

/// The sheet: a roll only as far as it is cut.
std::array<double, 2> sheet_of(const Trace& trace, const Box& drawn) {
  const bool roll = trace.page_length_mm > 1000;
  return {trace.page_width_mm,
          roll && !drawn.empty() ? std::max(drawn.y1, 1.0) : trace.page_length_mm};
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
  const Box drawn = bounds(trace.points);
  const std::array<double, 2> sheet = sheet_of(trace, drawn);
  const SheetFrame frame = sheet_frame(drawn, sheet);
  const double letter = frame.text_mm, row_mm = 1.5 * letter;
  const std::size_t rows = looks.size() + (trace.clipped_mm > 0 ? 5u : 4u);
  const double inset = frame.whole ? 0.0 : 7 * letter;  // the sheet, small, below the legend
  const double height = frame.shown.height() + row_mm * static_cast<double>(rows) + inset;
  // Wide enough for the legend of a narrow roll.
  const double width = std::max(frame.shown.width(), 40 * letter);
  std::string svg = svg_head(fmt::format("width=\"{2:.6g}mm\" height=\"{3:.6g}mm\" "
                                         "viewBox=\"{0:.6g} {1:.6g} {2:.6g} {3:.6g}\"",
                                         frame.shown.x0, frame.shown.y0, width, height),
                             fmt::format("What {} did", trace.machine));
  const auto white = [&](double y) {
    return fmt::format(
        "<rect x=\"{:.6g}\" y=\"{:.6g}\" width=\"{:.6g}\" height=\"{:.6g}\" fill=\"#fff\"/>\n",
        frame.shown.x0, y, width, height);
  };
  svg += white(frame.shown.y0) + sheet_rect_svg(frame, sheet) + white(frame.shown.y1);
  auto out = std::back_inserter(svg);
  fmt::format_to(out,
                 "<path class=\"travel\" d=\"{}\" fill=\"none\" stroke=\"#3a9\" "
                 "stroke-width=\"{:.3f}\"/>\n",
                 travel_path(trace), frame.line_mm / 3);
  const double legend_x = frame.shown.x0 + letter;
  double y = frame.shown.y1 + row_mm;
  const auto legend_row = [&](const std::string& stroke, double line_mm, const std::string& words) {
    fmt::format_to(out,
                   "<path d=\"M{0:.6g},{1:.6g}h{2:.6g}\" stroke=\"{3}\" "
                   "stroke-width=\"{4:.3f}\"/><text x=\"{5:.6g}\" y=\"{6:.6g}\" "
                   "font-family=\"sans-serif\" font-size=\"{7:.3f}\">{8}</text>\n",
                   legend_x, y - 0.35 * letter, 3 * letter, stroke, line_mm, legend_x + 4 * letter,
                   y, letter, xml_escaped(shortened(words, letter, width - 6 * letter)));
    y += row_mm;
  };
  std::size_t rank = 0;
  for (const auto& [look, strokes] : looks) {
    const std::string stroke = colour(rank++, looks.size());
    fmt::format_to(
        out,
        "<path class=\"cut\" d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{:.3f}\" "
        "stroke-linecap=\"round\"/>\n",
        strokes.path, stroke, frame.line_mm);
    legend_row(stroke, 2 * frame.line_mm, legend_words(look, strokes.mm));
  }
  if (trace.clipped_mm > 0) {
    std::string grey;
    for (std::size_t i = 0; i + 1 < trace.clipped.size(); i += 2)
      put_path(grey, std::span(trace.clipped).subspan(i, 2));
    // White first, to hide the colour of the force where nothing was cut.
    fmt::format_to(out,
                   "<path d=\"{0}\" fill=\"none\" stroke=\"#fff\" stroke-width=\"{1:.3f}\"/>\n"
                   "<path class=\"clipped\" d=\"{0}\" fill=\"none\" stroke=\"#aaa\" "
                   "stroke-width=\"{2:.3f}\"/>\n",
                   grey, 3 * frame.line_mm, 1.4 * frame.line_mm);
    legend_row("#aaa", 2 * frame.line_mm,
               fmt::format("outside the window, not cut: {:.1f} mm", trace.clipped_mm));
  }
  legend_row("#3a9", frame.line_mm / 2,
             fmt::format("travel with the tool up: {:.1f} mm", trace.travel_mm));
  legend_row("none", 0,
             fmt::format("{}: {:.1f} mm in {} strokes, {:.0f} s", trace.machine, trace.cut_mm,
                         trace.lifts, trace.seconds));
  legend_row("none", 0, sheet_words(drawn, {trace.page_width_mm, trace.page_length_mm}));
  svg += sheet_inset_svg(frame, drawn, sheet, {legend_x, y - letter / 2}, 6 * letter);
  return svg + "</svg>\n";
}

}  // namespace popcut
