// SPDX-License-Identifier: MIT
// Part of core/plan/plan.hpp.
#include <algorithm>
#include <array>
#include <iterator>
#include <vector>

#include <fmt/compile.h>
#include <fmt/format.h>

#include "core/drawing/sheet_frame.hpp"
#include "core/layout/layout.hpp"
#include "core/plan/plan.hpp"
#include "core/text/svg_document.hpp"
#include "core/text/text_sink.hpp"
#include "core/text/text_width.hpp"

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

void open_layer(std::string& svg, const Layer& layer, double line_mm) {
  fmt::format_to(Out(svg),
                 "<g id=\"{0}\" inkscape:groupmode=\"layer\" inkscape:label=\"{0}\" fill=\"none\" "
                 "stroke=\"{1}\" stroke-width=\"{3:.2f}\" data-assignment=\"{2}\">\n",
                 operation_name(layer.operation), layer.colour, layer.assignment, line_mm);
}

}  // namespace

std::string sheet_svg(const PlannedSheet& sheet, const std::string& title,
                      const std::string& print) {
  std::string svg;
  svg.reserve(512 + print.size() + 90 * sheet.path.strokes.size() + 24 * sheet.path.points.size());
  const KnifeWork& knife = sheet.knife;
  const std::string attributes = fmt::format(
      " data-popcut=\"{}\" data-overcut=\"{:g}\" data-rounds=\"{}\" data-blade-offset=\"{:g}\" "
      "data-blade-tools=\"{}\"",
      sheet.whole_folds ? "sheet" : "dashes", knife.overcut_mm, knife.rounds, knife.blade_offset_mm,
      knife.blade_tools);
  head(svg, sheet.area_mm, title, attributes.c_str());
  if (!print.empty())
    svg += "<g id=\"print\" inkscape:groupmode=\"layer\" inkscape:label=\"print\">\n" + print +
           "</g>\n";
  const double line_mm = seen_line_mm(sheet.area_mm[0], sheet.area_mm[1]);
  for (const Layer& layer : kLayers) {
    bool open = false;
    for (std::size_t i = 0; i < sheet.path.strokes.size(); ++i) {
      const Stroke& stroke = sheet.path.strokes[i];
      if (stroke.operation != layer.operation) continue;
      if (!open) open_layer(svg, layer, line_mm);
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
  // Beside each other, each as large as what is drawn on it.
  std::vector<SheetFrame> frames;
  std::vector<Box> drawn;
  double width = 0.0, height = 0.0, letter = 0.0;
  for (const PlannedSheet& sheet : plan.sheets) {
    drawn.push_back(bounds(sheet.path.points));
    frames.push_back(sheet_frame(drawn.back(), sheet.area_mm));
    width += frames.back().shown.width();
    height = std::max(height, frames.back().shown.height());
  }
  for (const SheetFrame& frame : frames) letter = std::max(letter, frame.text_mm);
  letter *= width / std::max(1.0, frames.front().shown.width());
  const double words = 4.5 * letter;
  std::string svg;
  head(svg, {width, height + words}, plan.name + ": assembly", "");
  fmt::format_to(Out(svg), "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n");
  double x = 0.0;
  for (std::size_t i = 0; i < plan.sheets.size(); ++i) {
    const PlannedSheet& sheet = plan.sheets[i];
    const SheetFrame& frame = frames[i];
    const std::array rows{fmt::format("{}: sheet {}{}", plan.name, i + 1,
                                      sheet.transform.xy != 0.0 ? ", turned by 90 degrees" : ""),
                          sheet_words(drawn[i], sheet.area_mm), plan.machine.title};
    for (std::size_t k = 0; k < rows.size(); ++k)
      fmt::format_to(Out(svg),
                     "<text x=\"{:.3f}\" y=\"{:.3f}\" font-family=\"sans-serif\" "
                     "font-size=\"{:.3f}\" fill=\"#404040\">{}</text>\n",
                     x + letter / 2, height + (static_cast<double>(k) + 1) * 1.35 * letter, letter,
                     xml_escaped(shortened(rows[k], letter, frame.shown.width() - letter)));
    fmt::format_to(Out(svg),
                   "<svg x=\"{0:.3f}\" width=\"{3:.3f}\" height=\"{4:.3f}\" "
                   "viewBox=\"{1:.3f} {2:.3f} {3:.3f} {4:.3f}\" fill=\"none\" "
                   "stroke-width=\"{5:.3f}\">\n{6}",
                   x, frame.shown.x0, frame.shown.y0, frame.shown.width(), frame.shown.height(),
                   frame.line_mm, sheet_rect_svg(frame, sheet.area_mm));
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
    svg += "</svg>\n";
    x += frame.shown.width();
  }
  svg += "</svg>\n";
  return svg;
}

}  // namespace popcut
