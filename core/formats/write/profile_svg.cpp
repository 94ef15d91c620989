// SPDX-License-Identifier: MIT
#include "core/formats/write/profile_svg.hpp"

#include <algorithm>
#include <string_view>

#include <fmt/format.h>

#include "core/text/svg_document.hpp"
#include "core/text/text_sink.hpp"

namespace popcut {
namespace {

struct Colour {
  Operation operation;
  std::string_view stroke;
};

// LightBurn's palette, in which each colour is a layer.
constexpr std::array<Colour, 6> kLightburn{{{Operation::Draw, "#00e000"},
                                            {Operation::Score, "#00e000"},
                                            {Operation::FoldMountain, "#ff0000"},
                                            {Operation::FoldValley, "#0000ff"},
                                            {Operation::Cut, "#000000"},
                                            {Operation::Outline, "#000000"}}};

void put_path(TextSink& text, std::span<const PagePoint> points) {
  text.put("<path d=\"");
  const bool ring = points.size() > 3 && closed(points);
  for (std::size_t i = 0; i + (ring ? 1 : 0) < points.size(); ++i) {
    text.put(i == 0 ? "M" : "L");
    text.put_rounded(points[i].x);
    text.put(",");
    text.put_rounded(points[i].y);
  }
  text.put(ring ? "Z\"/>\n" : "\"/>\n");
}

std::string_view origami_style(Operation operation) {
  switch (operation) {
    case Operation::FoldMountain:
      return "stroke=\"#ff0000\" opacity=\"0.5\"";
    case Operation::FoldValley:
      return "stroke=\"#0000ff\" opacity=\"0.5\"";
    case Operation::Cut:
      return "stroke=\"#00ff00\"";
    case Operation::Outline:
      return "stroke=\"#000000\"";
    default:
      return {};
  }
}

double shortest_line(const LineWork& work) {
  double shortest = 1e300;
  for (const DrawnLine& line : work.lines) {
    const auto points = work.points_of(line);
    for (std::size_t i = 1; i < points.size(); ++i)
      if (const double l = distance(points[i - 1], points[i]); l > 1e-6)
        shortest = std::min(shortest, l);
  }
  return shortest;
}

}  // namespace

void write_lightburn_svg(const LineWork& dashed, const std::array<double, 2>& page_mm,
                         std::ostream& out) {
  TextSink text(out);
  text.put(svg_head(fmt::format("{0} width=\"{1}mm\" height=\"{2}mm\" viewBox=\"0 0 {1} {2}\"",
                                kDashed, page_mm[0], page_mm[1]),
                    dashed.name));
  for (const Colour& colour : kLightburn) {
    bool open = false;
    for (const DrawnLine& line : dashed.lines) {
      if (line.operation != colour.operation) continue;
      if (!open)
        text("<g id=\"", std::string_view(operation_name(colour.operation)),
             "\" fill=\"none\" stroke-width=\"0.1\" stroke=\"", colour.stroke, "\">\n");
      open = true;
      put_path(text, dashed.points_of(line));
    }
    if (open) text.put("</g>\n");
  }
  text.put("</svg>\n");
}

void write_origami_sim_svg(const LineWork& whole, std::ostream& out) {
  const Box box = bounds(whole);
  const double scale = std::clamp(30.0 / shortest_line(whole), 1.0, 1000.0);
  TextSink text(out);
  text.put(svg_head(fmt::format("version=\"1.1\" viewBox=\"0 0 {} {}\"",
                                rounded(box.empty() ? 1.0 : box.width() * scale),
                                rounded(box.empty() ? 1.0 : box.height() * scale)),
                    whole.name));
  for (const DrawnLine& line : whole.lines) {
    const std::string_view style = origami_style(line.operation);
    if (style.empty()) continue;
    const auto points = whole.points_of(line);
    for (std::size_t i = 1; i < points.size(); ++i) {
      text.put("<line ");
      const auto number = [&](std::string_view name, double value) {
        text.put(name);
        text.put_rounded(value * scale);
        text.put("\" ");
      };
      number("x1=\"", points[i - 1].x - box.x0);
      number("y1=\"", points[i - 1].y - box.y0);
      number("x2=\"", points[i].x - box.x0);
      number("y2=\"", points[i].y - box.y0);
      text(style, "/>\n");
    }
  }
  text.put("</svg>\n");
}

}  // namespace popcut
