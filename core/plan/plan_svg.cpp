// SPDX-License-Identifier: MIT
// Part of core/plan/plan.hpp.
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "core/plan/plan.hpp"
#include "core/text/svg_document.hpp"
#include "core/text/text_sink.hpp"

namespace popcut {
namespace {

constexpr std::size_t kSteps = 48;       // number of colours
constexpr double kLegendMm = 64.0;       // width
constexpr double kLeastHeightMm = 90.0;  // needed by the legend

using Out = std::back_insert_iterator<std::string>;

std::string colour_at(double t) {
  constexpr std::array<std::array<double, 3>, 5> kRamp{
      {{31, 59, 156}, {23, 138, 180}, {46, 155, 80}, {214, 136, 0}, {190, 24, 43}}};
  const double x = std::clamp(t, 0.0, 1.0) * (kRamp.size() - 1);
  const auto i = std::min(static_cast<std::size_t>(x), kRamp.size() - 2);
  const double f = x - static_cast<double>(i);
  const auto channel = [&](std::size_t c) {
    return static_cast<int>(std::lround(kRamp[i][c] + f * (kRamp[i + 1][c] - kRamp[i][c])));
  };
  return fmt::format("#{:02x}{:02x}{:02x}", channel(0), channel(1), channel(2));
}

// Appends `mm` rounded to 0.01, without trailing zeros.
void put(std::string& svg, double mm) {
  const long long hundredths = std::llround(mm * 100);
  if (hundredths < 0) svg += '-';
  const unsigned long long size = static_cast<unsigned long long>(std::llabs(hundredths));
  char digits[kLongestNumber];
  svg.append(digits, std::to_chars(digits, digits + kLongestNumber, size / 100).ptr);
  if (size % 100 == 0) return;
  svg += '.';
  svg += static_cast<char>('0' + size % 100 / 10);
  if (size % 10 != 0) svg += static_cast<char>('0' + size % 10);
}

void put_point(std::string& svg, char letter, const PagePoint& p) {
  svg += letter;
  put(svg, p.x);
  svg += ' ';
  put(svg, p.y);
}

std::string clock(double seconds) {
  const auto whole = static_cast<long long>(std::llround(seconds));
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} h {:02} min", whole / 3600, whole % 3600 / 60);
}

void put_travel(std::string& svg, const Toolpath& path) {
  svg += "<path id=\"travel\" stroke=\"#707070\" stroke-width=\"0.1\" d=\"";
  for (std::size_t i = 1; i < path.strokes.size(); ++i) {
    put_point(svg, 'M', path.points_of(path.strokes[i - 1]).back());
    put_point(svg, 'L', path.points_of(path.strokes[i]).front());
  }
  svg += "\"/>\n";
}

void put_strokes(std::string& svg, const Toolpath& path) {
  const std::size_t n = path.strokes.size(), steps = std::min(n, kSteps);
  for (std::size_t step = 0; step < steps; ++step) {
    const double t = steps > 1 ? static_cast<double>(step) / static_cast<double>(steps - 1) : 0.0;
    fmt::format_to(Out(svg), "<path stroke=\"{}\" d=\"", colour_at(t));
    for (std::size_t i = step * n / steps; i < (step + 1) * n / steps; ++i) {
      const auto points = path.points_of(path.strokes[i]);
      for (std::size_t k = 0; k < points.size(); ++k) put_point(svg, k == 0 ? 'M' : 'L', points[k]);
    }
    svg += "\"/>\n";
  }
}

void put_text(std::string& svg, double x, double y, const std::string& text) {
  fmt::format_to(Out(svg), "<text x=\"{:.2f}\" y=\"{:.2f}\">{}</text>\n", x, y, xml_escaped(text));
}

void put_legend(std::string& svg, const PlannedSheet& sheet, const std::string& title) {
  const double x = sheet.area_mm[0] + 6, bar = 40;
  const std::size_t n = sheet.path.strokes.size();
  svg += "<g font-family=\"sans-serif\" font-size=\"4\" fill=\"#202020\" stroke=\"none\">\n";
  put_text(svg, x, 8, title);
  for (std::size_t k = 0; k < kSteps; ++k) {
    const double t = static_cast<double>(k) / (kSteps - 1);
    fmt::format_to(
        Out(svg), "<rect x=\"{:.2f}\" y=\"{:.3f}\" width=\"5\" height=\"{:.3f}\" fill=\"{}\"/>\n",
        x, 14 + bar * static_cast<double>(k) / kSteps, bar / kSteps + 0.05, colour_at(t));
  }
  put_text(svg, x + 8, 17, "stroke 1, cut first");
  put_text(svg, x + 8, 14 + bar / 2 + 1.5, fmt::format("stroke {}", (n + 1) / 2));
  put_text(svg, x + 8, 14 + bar, fmt::format("stroke {}, cut last", n));
  put_text(svg, x, 62, fmt::format("{} lifts", n));
  put_text(svg, x, 68, fmt::format("cut {:.0f} mm, folds {:.0f} mm", sheet.cut_mm, sheet.fold_mm));
  put_text(svg, x, 74,
           fmt::format("travel with the tool up {:.0f} mm (thin grey)", sheet.travel_mm));
  put_text(svg, x, 80, clock(sheet.seconds));
  put_text(svg, x, 86,
           fmt::format("{} to {}", clock(sheet.seconds_range[0]), clock(sheet.seconds_range[1])));
  svg += "</g>\n";
}

void put_mark(std::string& svg, const PagePoint& at, const std::string& colour) {
  fmt::format_to(Out(svg),
                 "<circle cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"1.2\" stroke=\"{}\" stroke-width=\"0.4\" "
                 "fill=\"#ffffff\"/>\n",
                 at.x, at.y, colour);
}

}  // namespace

std::string plan_svg(const PlannedSheet& sheet, const std::string& title) {
  const Toolpath& path = sheet.path;
  const double width = sheet.area_mm[0] + kLegendMm;
  const double height = std::max(sheet.area_mm[1], kLeastHeightMm);
  std::string svg;
  svg.reserve(8192 + 12 * path.points.size() + 24 * path.strokes.size());
  svg += svg_head(
      fmt::format("version=\"1.1\" width=\"{0}mm\" height=\"{1}mm\" viewBox=\"0 0 {0} {1}\"", width,
                  height),
      title);
  fmt::format_to(Out(svg),
                 "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n"
                 "<rect width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"#c0c0c0\" "
                 "stroke-width=\"0.3\"/>\n<g fill=\"none\" stroke-width=\"0.35\" "
                 "stroke-linecap=\"round\">\n",
                 sheet.area_mm[0], sheet.area_mm[1]);
  put_travel(svg, path);
  put_strokes(svg, path);
  if (!path.strokes.empty()) {
    put_mark(svg, path.points_of(path.strokes.front()).front(), colour_at(0));
    put_mark(svg, path.points_of(path.strokes.back()).back(), colour_at(1));
  }
  svg += "</g>\n";
  put_legend(svg, sheet, title);
  svg += "</svg>\n";
  return svg;
}

}  // namespace popcut
