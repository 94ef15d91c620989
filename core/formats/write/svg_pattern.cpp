// SPDX-License-Identifier: MIT
// Part of core/formats/write/pattern_files.hpp.
#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include <fmt/format.h>

#include "core/drawing/linework.hpp"
#include "core/drawing/sheet_frame.hpp"
#include "core/formats/write/pattern_files.hpp"
#include "core/text/svg_document.hpp"
#include "core/text/text_sink.hpp"

namespace popcut {
namespace {

struct SvgLayer {
  EdgeRole role;
  std::string_view label;
  std::string_view colour;
  std::string_view dashes;  // for display only
  std::string_view assignment;
  std::string_view fold_angle;
};

// In cutting order: no part may move before it is cut.
constexpr std::array<SvgLayer, 4> kSvgLayers{{
    {EdgeRole::Mountain, "fold-mountain", "#ff0000", "3 1 0.5 1", "M", "-90"},
    {EdgeRole::Valley, "fold-valley", "#0000ff", "2 1", "V", "90"},
    {EdgeRole::Slit, "cut", "#000000", "", "C", "0"},
    {EdgeRole::Outline, "outline", "#000000", "", "B", "0"},
}};

/// The drawn part of the page: the sheet from its corner; without a card, the bounds of the lines.
Box page_of(const Pattern& pattern) {
  if (pattern.card || pattern.lines.empty())
    return {0, 0, pattern.width_mm, pattern.wall_mm + pattern.ground_mm};
  // From the origin, where readers that know no viewBox put it too.
  Box page;
  page.add({0.0, 0.0});
  for (const SheetLine& line : pattern.lines) {
    page.add({line.v0, line.u0});
    page.add({line.v1, line.u1});
  }
  return page;
}

// Wide enough to be seen when all of the sheet is.
double line_width_mm(const Pattern& pattern) {
  const Box page = page_of(pattern);
  return std::max(0.25, std::round(seen_line_mm(page.width(), page.height()) * 100) / 100);
}

void put_head(TextSink& text, const Pattern& pattern, std::string_view attribute) {
  const Box page = page_of(pattern);
  const std::string width = rounded(page.width()), height = rounded(page.height());
  text.put(svg_head(fmt::format("{} version=\"1.1\"{} width=\"{}mm\" height=\"{}mm\" "
                                "viewBox=\"{} {} {} {}\"",
                                kInkscape, attribute, width, height, rounded(page.x0),
                                rounded(page.y0), width, height),
                    pattern.name));
}

void put_line(TextSink& text, const SheetLine& line, const SvgLayer& layer) {
  text.put("<path d=\"M");
  text.put_rounded(line.v0);
  text.put(",");
  text.put_rounded(line.u0);
  text.put("L");
  text.put_rounded(line.v1);
  text.put(",");
  text.put_rounded(line.u1);
  text("\" stroke=\"", layer.colour, "\" data-assignment=\"", layer.assignment,
       "\" data-foldAngle=\"", layer.fold_angle, "\"/>\n");
}

void put_layer(TextSink& text, const SvgLayer& layer, bool dashed, double line_mm,
               std::span<const SheetLine> lines) {
  text("<g inkscape:groupmode=\"layer\" inkscape:label=\"", layer.label, "\" id=\"", layer.label,
       "\" fill=\"none\" stroke=\"", layer.colour, "\" stroke-width=\"", rounded(line_mm), "\"");
  if (dashed && !layer.dashes.empty()) text(" stroke-dasharray=\"", layer.dashes, "\"");
  text.put(">\n");
  for (const SheetLine& line : lines)
    if (line.role == layer.role) put_line(text, line, layer);
  text.put("</g>\n");
}

}  // namespace

void write_pattern_svg(const Pattern& pattern, std::ostream& out) {
  TextSink text(out);
  put_head(text, pattern, "");
  const double line_mm = line_width_mm(pattern);
  for (const SvgLayer& layer : kSvgLayers) put_layer(text, layer, true, line_mm, pattern.lines);
  text.put("</svg>\n");
}

void write_cut_svg(const Pattern& pattern, std::span<const SheetLine> micro_cuts,
                   std::ostream& out) {
  TextSink text(out);
  put_head(text, pattern, " data-popcut=\"dashes\"");
  const double line_mm = line_width_mm(pattern);
  for (const SvgLayer& layer : kSvgLayers) {
    const bool fold = layer.role == EdgeRole::Mountain || layer.role == EdgeRole::Valley;
    put_layer(text, layer, false, line_mm,
              fold ? micro_cuts : std::span<const SheetLine>(pattern.lines));
  }
  text.put("</svg>\n");
}

}  // namespace popcut
