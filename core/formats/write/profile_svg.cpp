// SPDX-License-Identifier: MIT
#include "core/formats/write/profile_svg.hpp"

#include <algorithm>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "core/text/svg_document.hpp"
#include "core/text/text_sink.hpp"

namespace popcut {
namespace {

/// A layer of one colour, for the operations from `first` to `last`.
struct Layer {
  std::string_view name, colour;
  Operation first, last;
};

// LightBurn's palette, in which each colour is a layer.
constexpr std::array<Layer, 6> kLightburn{
    {{"draw", "#00e000", Operation::Draw, Operation::Draw},
     {"score", "#00e000", Operation::Score, Operation::Score},
     {"fold-mountain", "#ff0000", Operation::FoldMountain, Operation::FoldMountain},
     {"fold-valley", "#0000ff", Operation::FoldValley, Operation::FoldValley},
     {"cut", "#000000", Operation::Cut, Operation::Cut},
     {"outline", "#000000", Operation::Outline, Operation::Outline}}};

/// A group of the drawing for Cricut: what Design Space calls an operation.
struct CricutGroup {
  std::string_view operation, colour;
  bool one_path;  ///< all its lines are one path, so one layer
};

// In the order of work.
constexpr std::array<CricutGroup, 3> kCricut{
    {{"draw", "#00a651", true}, {"score", "#ff0000", true}, {"cut", "#000000", false}}};

std::size_t cricut_group(Operation operation, bool dashed) {
  if (operation == Operation::Draw) return 0;
  if (operation == Operation::Score) return 1;
  return is_fold(operation) && !dashed ? 1 : 2;
}

void put_data(TextSink& text, std::span<const PagePoint> points) {
  const bool ring = points.size() > 3 && closed(points);
  for (std::size_t i = 0; i + (ring ? 1 : 0) < points.size(); ++i) {
    text.put(i == 0 ? "M" : "L");
    text.put_rounded(points[i].x);
    text.put(",");
    text.put_rounded(points[i].y);
  }
  if (ring) text.put("Z");
}

void put_path(TextSink& text, std::span<const PagePoint> points) {
  text.put("<path d=\"");
  put_data(text, points);
  text.put("\"/>\n");
}

/// Writes the strokes of a layer, operation by operation, as a group with these attributes.
void put_layer(TextSink& text, const LineWork& dashed, const Layer& layer,
               const std::string& attributes) {
  bool any = false;
  for (auto operation = layer.first; operation <= layer.last;
       operation = static_cast<Operation>(static_cast<int>(operation) + 1))
    for (const DrawnLine& line : dashed.lines) {
      if (line.operation != operation) continue;
      if (!std::exchange(any, true))
        text("<g id=\"", layer.name, "\" fill=\"none\" ", attributes, ">\n");
      put_path(text, dashed.points_of(line));
    }
  if (any) text.put("</g>\n");
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
  for (const Layer& layer : kLightburn)
    put_layer(text, dashed, layer, fmt::format("stroke-width=\"0.1\" stroke=\"{}\"", layer.colour));
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

Result<void> write_cricut_svg(const LineWork& drawing, const CricutMat& mat, std::ostream& out) {
  constexpr double kMmPerInch = 25.4, kPointsPerInch = 72.0;
  const double width = mat.width_in * kMmPerInch, height = mat.height_in * kMmPerInch;
  constexpr double kRounding = 1e-6;
  const Box box = bounds(drawing);
  const auto fits = [&](double x, double y) {
    return box.empty() || (x <= width + kRounding && y <= height + kRounding);
  };
  const bool upright = fits(box.width(), box.height());
  if (!upright && !fits(box.height(), box.width())) {
    return fail(
        ErrorKind::Infeasible, "cricut",
        fmt::format("the drawing is {:.1f} x {:.1f} mm, but the mat holds {:.1f} x {:.1f} mm "
                    "({:g} x {:g} in)",
                    box.width(), box.height(), width, height, mat.width_in, mat.height_in));
  }
  // Turned clockwise by 90 degrees if needed: a rotation, so nothing is mirrored.
  LineWork placed = drawing;
  constexpr double kScale = kPointsPerInch / kMmPerInch;
  for (PagePoint& p : placed.points)
    p = upright ? PagePoint{kScale * (p.x - box.x0), kScale * (p.y - box.y0)}
                : PagePoint{kScale * (box.y1 - p.y), kScale * (p.x - box.x0)};
  TextSink text(out);
  text.put(svg_head(fmt::format("{} width=\"{}in\" height=\"{}in\" viewBox=\"0 0 {} {}\"", kDashed,
                                mat.width_in, mat.height_in, rounded(mat.width_in * kPointsPerInch),
                                rounded(mat.height_in * kPointsPerInch)),
                    drawing.name));
  for (std::size_t k = 0; k < kCricut.size(); ++k) {
    const CricutGroup& group = kCricut[k];
    bool any = false;
    for (const DrawnLine& line : placed.lines) {
      if (cricut_group(line.operation, drawing.dashed) != k) continue;
      if (!std::exchange(any, true)) {
        text("<g id=\"", group.operation, "\" fill=\"none\" stroke=\"", group.colour,
             "\" stroke-width=\"0.75\" data-assignment=\"", group.operation, "\">\n");
        if (group.one_path) text.put("<path d=\"");
      }
      if (group.one_path)
        put_data(text, placed.points_of(line));
      else
        put_path(text, placed.points_of(line));
    }
    if (any) text.put(group.one_path ? "\"/>\n</g>\n" : "</g>\n");
  }
  text.put("</svg>\n");
  return {};
}

}  // namespace popcut
