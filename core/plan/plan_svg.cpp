// SPDX-License-Identifier: MIT
// Part of core/plan/plan.hpp.
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <iterator>
#include <string_view>

#include <fmt/format.h>

#include "core/drawing/sheet_frame.hpp"
#include "core/plan/plan.hpp"
#include "core/text/svg_document.hpp"
#include "core/text/text_sink.hpp"
#include "core/text/text_width.hpp"

namespace popcut {
namespace {

constexpr std::size_t kSteps = 48;    // number of colours
constexpr double kLegendEms = 20.0;   // width of the legend, in sizes of its letters
constexpr double kLegendRows = 24.0;  // height of the legend, in sizes of its letters
constexpr double kInsetEms = 8.0;

using Out = std::back_insert_iterator<std::string>;

std::string colour_at(double t) {
  constexpr std::array<std::array<double, 3>, 5> kRamp{
      {{31, 59, 156}, {23, 138, 180}, {46, 155, 80}, {214, 136, 0}, {190, 24, 43}}};
  const double x = std::clamp(t, 0.0, 1.0) * (kRamp.size() - 1);
  const auto i = std::min(static_cast<std::size_t>(x), kRamp.size() - 2);
  const double f = x - static_cast<double>(i);
  const auto channel = [&](std::size_t c) {
    return static_cast<int>(std::llround(kRamp[i][c] + f * (kRamp[i + 1][c] - kRamp[i][c])));
  };
  return fmt::format("#{:02x}{:02x}{:02x}", channel(0), channel(1), channel(2));
}

// Appends `mm` rounded to 0.01, without trailing zeros.
void put(std::string& svg, double mm) {
  const long long hundredths = std::llround(mm * 100);
  if (hundredths < 0) svg += '-';
  const auto size = static_cast<unsigned long long>(std::llabs(hundredths));
  std::array<char, kLongestNumber> digits;
  svg.append(digits.data(),
             std::to_chars(digits.data(), digits.data() + digits.size(), size / 100).ptr);
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

void put_travel(std::string& svg, const Toolpath& path, double line_mm) {
  fmt::format_to(Out(svg), "<path id=\"travel\" stroke=\"#808080\" stroke-width=\"{:.3f}\" d=\"",
                 line_mm);
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

// Rows of text, as high as letters need, that never leave the legend.
class Rows {
 public:
  Rows(std::string& svg, const PagePoint& corner, double letter_mm)
      : svg_(svg), x_(corner.x), y_(corner.y), letter_mm_(letter_mm) {}

  void put(std::string_view text, double indent_ems = 0.0) {
    y_ += 1.5 * letter_mm_;
    put_at(y_, text, indent_ems);
  }
  void put_at(double y, std::string_view text, double indent_ems = 0.0) {
    const double width = (kLegendEms - 1.0 - indent_ems) * letter_mm_;
    fmt::format_to(Out(svg_), "<text x=\"{:.2f}\" y=\"{:.2f}\">{}</text>\n",
                   x_ + indent_ems * letter_mm_, y,
                   xml_escaped(shortened(text, letter_mm_, width)));
  }
  [[nodiscard]] double down() const { return y_; }
  void skip(double ems) { y_ += ems * letter_mm_; }

 private:
  std::string& svg_;
  double x_, y_, letter_mm_;
};

void put_legend(std::string& svg, const PlannedSheet& sheet, const std::string& title,
                const SheetFrame& frame, const Box& drawn) {
  const double letter = frame.text_mm, x = frame.shown.x1 + letter / 2, bar = 8 * letter;
  const std::size_t n = sheet.path.strokes.size();
  fmt::format_to(Out(svg),
                 "<g font-family=\"sans-serif\" font-size=\"{:.2f}\" fill=\"#202020\" "
                 "stroke=\"none\">\n",
                 letter);
  Rows rows(svg, {x, frame.shown.y0}, letter);
  rows.put(title);
  rows.skip(1.0);
  const double top = rows.down();
  for (std::size_t k = 0; k < kSteps; ++k) {
    const double t = static_cast<double>(k) / (kSteps - 1);
    fmt::format_to(
        Out(svg),
        "<rect x=\"{:.2f}\" y=\"{:.3f}\" width=\"{:.2f}\" height=\"{:.3f}\" fill=\"{}\"/>\n", x,
        top + bar * static_cast<double>(k) / kSteps, letter, bar / kSteps * 1.05, colour_at(t));
  }
  rows.put_at(top + letter, "stroke 1, cut first", 1.6);
  rows.put_at(top + bar / 2 + letter / 2, fmt::format("stroke {}", (n + 1) / 2), 1.6);
  rows.put_at(top + bar, fmt::format("stroke {}, cut last", n), 1.6);
  rows.skip(8.5);
  rows.put(fmt::format("{} lifts", n));
  rows.put(fmt::format("cut {:.0f} mm, folds {:.0f} mm", sheet.cut_mm, sheet.fold_mm));
  rows.put(fmt::format("travel {:.0f} mm (thin grey)", sheet.travel_mm));
  if (sheet.seconds > 0) {
    rows.put(clock(sheet.seconds));
    rows.put(
        fmt::format("({} to {})", clock(sheet.seconds_range[0]), clock(sheet.seconds_range[1])));
  }
  rows.put(fmt::format("{:.1f} x {:.1f} mm on a sheet", drawn.width(), drawn.height()));
  rows.put(fmt::format("of {:.1f} x {:.1f} mm", sheet.area_mm[0], sheet.area_mm[1]));
  svg += "</g>\n";
  rows.skip(0.8);
  svg += sheet_inset_svg(frame, drawn, sheet.area_mm, {x, rows.down()}, kInsetEms * letter);
}

void put_mark(std::string& svg, const PagePoint& at, const std::string& colour, double line_mm) {
  fmt::format_to(Out(svg),
                 "<circle cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"{:.3f}\" stroke=\"{}\" "
                 "stroke-width=\"{:.3f}\" fill=\"#ffffff\"/>\n",
                 at.x, at.y, 3 * line_mm, colour, line_mm);
}

}  // namespace

std::string plan_svg(const PlannedSheet& sheet, const std::string& title) {
  const Toolpath& path = sheet.path;
  const Box drawn = bounds(path.points);
  const SheetFrame frame = sheet_frame(drawn, sheet.area_mm, kLegendEms);
  const double width = frame.shown.width() + kLegendEms * frame.text_mm;
  const double least = (kLegendRows + (frame.whole ? 0.0 : kInsetEms)) * frame.text_mm;
  const double height = std::max(frame.shown.height(), least);
  std::string svg;
  svg.reserve(8192 + 18 * path.points.size() +
              36 * path.strokes.size());  // untouched pages cost nothing
  svg += svg_head(fmt::format("version=\"1.1\" width=\"{2:.3f}mm\" height=\"{3:.3f}mm\" "
                              "viewBox=\"{0:.3f} {1:.3f} {2:.3f} {3:.3f}\"",
                              frame.shown.x0, frame.shown.y0, width, height),
                  title);
  fmt::format_to(Out(svg),
                 "<rect x=\"{:.3f}\" y=\"{:.3f}\" width=\"100%\" height=\"100%\" "
                 "fill=\"#ffffff\"/>\n{}",
                 frame.shown.x0, frame.shown.y0, sheet_rect_svg(frame, sheet.area_mm));
  // The sheet goes on below the legend.
  fmt::format_to(Out(svg),
                 "<rect x=\"{:.3f}\" y=\"{:.3f}\" width=\"100%\" height=\"100%\" "
                 "fill=\"#ffffff\"/>\n<g fill=\"none\" stroke-width=\"{:.3f}\" "
                 "stroke-linecap=\"round\">\n",
                 frame.shown.x1, frame.shown.y0, frame.line_mm);
  put_travel(svg, path, frame.line_mm / 3);
  put_strokes(svg, path);
  if (!path.strokes.empty()) {
    put_mark(svg, path.points_of(path.strokes.front()).front(), colour_at(0), frame.line_mm);
    put_mark(svg, path.points_of(path.strokes.back()).back(), colour_at(1), frame.line_mm);
  }
  svg += "</g>\n";
  put_legend(svg, sheet, title, frame, drawn);
  svg += "</svg>\n";
  return svg;
}

}  // namespace popcut
