// SPDX-License-Identifier: MIT
// Part of core/plan/plan.hpp.
#include <algorithm>
#include <array>
#include <iterator>

#include <fmt/compile.h>
#include <fmt/format.h>

#include "core/layout/layout.hpp"
#include "core/plan/plan.hpp"
#include "core/text/svg_document.hpp"
#include "core/text/text_sink.hpp"

namespace popcut {
namespace {

struct Layer {
  Operation operation;
  const char* colour;
  const char* assignment;
};
constexpr std::array kLayers{
    Layer{Operation::Draw, "#808080", "draw"},      Layer{Operation::Score, "#008080", "score"},
    Layer{Operation::FoldMountain, "#ff0000", "M"}, Layer{Operation::FoldValley, "#0000ff", "V"},
    Layer{Operation::Cut, "#000000", "C"},          Layer{Operation::Outline, "#000001", "B"}};

using Out = std::back_insert_iterator<std::string>;

void path_data(std::string& svg, std::span<const PagePoint> points) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    svg += i == 0 ? 'M' : i == 1 ? 'L' : ' ';
    append_rounded(svg, points[i].x);
    svg += ',';
    append_rounded(svg, points[i].y);
  }
}

void head(std::string& svg, const std::array<double, 2>& size, const std::string& title,
          const char* attributes) {
  svg += svg_head(
      fmt::format("{0} version=\"1.1\" width=\"{1}mm\" height=\"{2}mm\" viewBox=\"0 0 {1} {2}\"{3}",
                  kInkscape, size[0], size[1], attributes),
      title);
}

void open_layer(std::string& svg, const Layer& layer) {
  fmt::format_to(Out(svg),
                 "<g id=\"{0}\" inkscape:groupmode=\"layer\" inkscape:label=\"{0}\" fill=\"none\" "
                 "stroke=\"{1}\" stroke-width=\"0.1\" data-assignment=\"{2}\">\n",
                 operation_name(layer.operation), layer.colour, layer.assignment);
}

}  // namespace

std::string sheet_svg(const PlannedSheet& sheet, const std::string& title) {
  std::string svg;
  svg.reserve(256 + 90 * sheet.path.strokes.size() + 24 * sheet.path.points.size());
  const KnifeWork& knife = sheet.knife;
  const std::string attributes = fmt::format(
      " data-popcut=\"dashes\" data-overcut=\"{:g}\" data-rounds=\"{}\" data-blade-offset=\"{:g}\" "
      "data-blade-tools=\"{}\"",
      knife.overcut_mm, knife.rounds, knife.blade_offset_mm, knife.blade_tools);
  head(svg, sheet.area_mm, title, attributes.c_str());
  for (const Layer& layer : kLayers) {
    bool open = false;
    for (std::size_t i = 0; i < sheet.path.strokes.size(); ++i) {
      const Stroke& stroke = sheet.path.strokes[i];
      if (stroke.operation != layer.operation) continue;
      if (!open) open_layer(svg, layer);
      open = true;
      svg += "<path d=\"";
      path_data(svg, sheet.path.points_of(stroke));
      fmt::format_to(Out(svg), FMT_COMPILE("\" data-assignment=\"{}\" data-order=\"{}\"/>\n"),
                     layer.assignment, i + 1);
    }
    if (open) svg += "</g>\n";
  }
  svg += "</svg>\n";
  return svg;
}

std::string assembly_svg(const Plan& plan) {
  if (plan.layout) return assembly_svg(*plan.layout, plan.whole);
  constexpr double kBetween = 10.0;  // mm between sheets, with room for their names
  std::array<double, 2> size{kBetween, 0.0};
  for (const PlannedSheet& sheet : plan.sheets) {
    size[0] += sheet.area_mm[0] + kBetween;
    size[1] = std::max(size[1], sheet.area_mm[1] + 2 * kBetween);
  }
  std::string svg;
  head(svg, size, plan.name + ": assembly", "");
  double x = kBetween;
  for (std::size_t i = 0; i < plan.sheets.size(); ++i) {
    const PlannedSheet& sheet = plan.sheets[i];
    const Placement& t = sheet.transform;
    const bool turned = t.xy != 0.0;
    fmt::format_to(
        Out(svg),
        "<g transform=\"translate({} {})\" fill=\"none\" stroke-width=\"0.3\">\n"
        "<rect width=\"{}\" height=\"{}\" stroke=\"#b0b0b0\"/>\n"
        "<text x=\"0\" y=\"-3\" font-family=\"sans-serif\" font-size=\"5\" fill=\"#404040\">"
        "sheet {}: {} on {}, at {:.1f},{:.1f} mm{}</text>\n",
        x, kBetween, sheet.area_mm[0], sheet.area_mm[1], i + 1, xml_escaped(plan.name),
        xml_escaped(plan.machine.name), t.x0, t.y0, turned ? ", turned by 90 degrees" : "");
    for (const Layer& layer : kLayers) {
      bool open = false;
      for (const Stroke& stroke : sheet.path.strokes) {
        if (stroke.operation != layer.operation) continue;
        if (!open) fmt::format_to(Out(svg), "<path stroke=\"{}\" d=\"", layer.colour);
        open = true;
        path_data(svg, sheet.path.points_of(stroke));
      }
      if (open) svg += "\"/>\n";
    }
    svg += "</g>\n";
    x += sheet.area_mm[0] + kBetween;
  }
  svg += "</svg>\n";
  return svg;
}

}  // namespace popcut
