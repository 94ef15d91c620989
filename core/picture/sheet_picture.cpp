// SPDX-License-Identifier: MIT
#include "core/picture/sheet_picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <ostream>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "core/picture/picture_words.hpp"
#include "core/text/svg_document.hpp"
#include "core/text/text_sink.hpp"

namespace popcut {
namespace {

constexpr double kLargestPx = 1200, kSheetMarginPx = 24, kSheetFootPx = 84;
constexpr std::size_t kMostDashed = 20'000;

struct Ink {
  EdgeRole role;
  std::string_view colour, dashes;
  double width;
};

constexpr std::array<Ink, 4> kInks{{{EdgeRole::Valley, "#1f4fd8", "6 3", 1.3},
                                    {EdgeRole::Mountain, "#d8241f", "9 3 1.5 3", 1.3},
                                    {EdgeRole::Slit, "#1c1a18", "", 1.3},
                                    {EdgeRole::Outline, "#1c1a18", "", 1.6}}};

/// What the lines take of the sheet, mm, on the page: x = v, y = u.
struct Extent {
  double x0{std::numeric_limits<double>::infinity()}, y0{x0}, x1{-x0}, y1{-x0};
};

/// A line on the page, px.
using PageLine = std::array<double, 4>;

/// The lines of one role; where they are too many, those that fall on the same half pixels once.
template <typename X, typename Y>
std::vector<PageLine> lines_of(const Pattern& pattern, EdgeRole role, const X& x_of, const Y& y_of,
                               bool each) {
  std::vector<PageLine> out;
  const auto half = [&](double px) { return each ? px : std::round(px * 2) / 2; };
  for (const SheetLine& line : pattern.lines)
    if (line.role == role)
      out.push_back(
          {half(x_of(line.v0)), half(y_of(line.u0)), half(x_of(line.v1)), half(y_of(line.u1))});
  if (each) return out;
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  std::erase_if(out, [](const PageLine& l) { return l[0] == l[2] && l[1] == l[3]; });
  return out;
}

void put_lines(TextSink& text, const std::vector<PageLine>& lines, const Ink& ink, bool is_dashed) {
  constexpr std::size_t kAtOnce = 200;  // programs take long over paths of many thousand lines
  for (std::size_t i = 0; i < lines.size(); i += kAtOnce) {
    text.put("<path d=\"");
    for (std::size_t k = i; k < std::min(lines.size(), i + kAtOnce); ++k)
      text("M", lines[k][0], " ", lines[k][1], "L", lines[k][2], " ", lines[k][3]);
    text("\" fill=\"none\" stroke=\"", ink.colour, "\" stroke-width=\"",
         is_dashed ? ink.width : 0.25 * ink.width, "\"");
    if (is_dashed && !ink.dashes.empty()) text(" stroke-dasharray=\"", ink.dashes, "\"");
    text.put("/>\n");
  }
}

}  // namespace

void write_sheet_picture(const Pattern& pattern, std::ostream& out) {
  Extent page;
  for (const SheetLine& line : pattern.lines) {
    page.x0 = std::min({page.x0, line.v0, line.v1}),
    page.x1 = std::max({page.x1, line.v0, line.v1});
    page.y0 = std::min({page.y0, line.u0, line.u1}),
    page.y1 = std::max({page.y1, line.u0, line.u1});
  }
  if (!(page.x1 > page.x0) || !(page.y1 > page.y0)) page = {0, 0, 1, 1};
  const double across = page.x1 - page.x0, down = page.y1 - page.y0;
  const double scale = (kLargestPx - 2 * kSheetMarginPx) / std::max(across, down);
  const double width = std::max(across * scale + 2 * kSheetMarginPx, 560.0);
  const double height = down * scale + 2 * kSheetMarginPx + kSheetFootPx;
  const double left = (width - across * scale) / 2;
  const auto tenths = [](double px) { return std::round(px * 10) / 10; };
  const auto x_of = [&](double v) { return tenths(left + (v - page.x0) * scale); };
  const auto y_of = [&](double u) { return tenths(kSheetMarginPx + (u - page.y0) * scale); };

  TextSink text(out);
  text.put(
      svg_head(fmt::format("width=\"{0:.0f}\" height=\"{1:.0f}\" viewBox=\"0 0 {0:.0f} {1:.0f}\"",
                           std::ceil(width), std::ceil(height)),
               pattern.name));
  put_rectangle(text, 0, 0, std::ceil(width), std::ceil(height), "#ffffff");
  if (pattern.card)
    put_rectangle(text, x_of(page.x0), y_of(page.y0), x_of(page.x1) - x_of(page.x0),
                  y_of(page.y1) - y_of(page.y0), "#fbf6ea");
  const bool is_dashed = pattern.lines.size() <= kMostDashed;
  for (const Ink& ink : kInks)
    put_lines(text, lines_of(pattern, ink.role, x_of, y_of, is_dashed), ink, is_dashed);

  const double foot = height - kSheetFootPx + 6;
  text.put(picture_text(kSheetMarginPx, foot + 18, pattern.name, "start", {.size = 20}));
  text.put(picture_text(kSheetMarginPx, foot + 44,
                        fmt::format("{:.4g} x {:.4g} mm; cuts black, mountain folds red, valley "
                                    "folds blue{}",
                                    across, down, is_dashed ? "" : "; coarse"),
                        "start", {.size = 16}));
  const double bar_mm = round_length(across / 2.5), bar_px = bar_mm * scale;
  constexpr int kParts = 5;
  for (int i = 0; i < kParts; ++i)
    text("<rect x=\"", tenths(kSheetMarginPx + bar_px * i / kParts), "\" y=\"", tenths(foot + 56),
         "\" width=\"", tenths(bar_px / kParts), "\" height=\"8\" fill=\"",
         i % 2 == 0 ? kPictureInk : std::string_view("#ffffff"), "\" stroke=\"", kPictureInk,
         "\" stroke-width=\"0.8\"/>\n");
  text.put(picture_text(kSheetMarginPx + bar_px + 8, foot + 66, fmt::format("{:g} mm", bar_mm),
                        "start", {.size = 16}));
  text.put("</svg>\n");
}

}  // namespace popcut
