// SPDX-License-Identifier: MIT
#include "daemon/pictures/artwork_pages.hpp"

#include <algorithm>
#include <vector>

#include <fmt/format.h>

#include "core/plan/marks.hpp"
#include "core/text/svg_document.hpp"
#include "daemon/pictures/artwork_pdf.hpp"

namespace popcut {
namespace {

std::array<double, 2> stretch_of(const PrintPageOptions& options) {
  return {100.0 / options.bars_mm[0], 100.0 / options.bars_mm[1]};
}

Result<void> check_page(const std::array<double, 2>& page, const std::array<double, 2>& sheet) {
  constexpr double kNoise = 1e-6;
  if (page[0] + kNoise >= sheet[0] && page[1] + kNoise >= sheet[1]) return {};
  return fail(ErrorKind::Infeasible, "--page",
              fmt::format("is {:g} x {:g} mm, smaller than the sheet of {:g} x {:g} mm; give a "
                          "larger page, or plan for a smaller one with --mat",
                          page[0], page[1], sheet[0], sheet[1]));
}

/// The lines of the pattern's page on a sheet, piece by piece.
std::string lines_on_sheet(const std::string& lines, const Plan& plan, std::size_t sheet) {
  if (lines.empty()) return {};
  const auto& area = plan.sheets[sheet].area_mm;
  std::string svg = svg_head(fmt::format(
      "width=\"{0:g}mm\" height=\"{1:g}mm\" viewBox=\"0 0 {0:g} {1:g}\"", area[0], area[1]));
  std::size_t k = 0;
  for (const PieceMap& piece : pieces_on_sheet(plan, sheet)) {
    std::string clip;
    if (!piece.polygons.empty()) {
      svg += fmt::format("<clipPath id=\"piece-{}\"><path d=\"", k);
      for (const auto& polygon : piece.polygons) {
        for (std::size_t n = 0; n < polygon.size(); ++n)
          svg += fmt::format("{}{:.4f} {:.4f}", n == 0 ? 'M' : 'L', polygon[n].x, polygon[n].y);
        svg += 'Z';
      }
      svg += "\"/></clipPath>\n";
      clip = fmt::format(" clip-path=\"url(#piece-{})\"", k);
    }
    const Placement& t = piece.to_sheet;
    svg += fmt::format("<g{}><g transform=\"matrix({} {} {} {} {} {})\">\n{}</g></g>\n", clip, t.xx,
                       t.yx, t.xy, t.yy, t.x0, t.y0, lines);
    ++k;
  }
  return svg + "</svg>\n";
}

/// Whether nothing is printed in a part of the sheet.
bool is_free(const PrintedSheet& raster, const Box& box) {
  for (std::size_t j = 0; j < raster.frame.height; ++j)
    for (std::size_t i = 0; i < raster.frame.width; ++i) {
      const PagePoint p = raster.frame.middle(i, j);
      if (p.x < box.x0 || p.x > box.x1 || p.y < box.y0 || p.y > box.y1) continue;
      if (raster.image.at(i, j)[3] != 0) return false;
    }
  return true;
}

/// A bar along the lower edge of the sheet, below where marks may be, if nothing else is there.
void add_bar(ArtworkPage& page, const PrintedSheet& raster, const std::array<double, 2>& area,
             const Plan& plan, std::size_t sheet, bool with_words) {
  constexpr double kFromEdge = 10, kHigh = 8;
  const double left = area[0] / 2 - 50, top = area[1] - kFromEdge - 3;
  const Box box{left - 2, top, left + 102, top + kHigh};
  const Box work = bounds(plan.sheets[sheet].path.points);
  if (left < 32 || !is_free(raster, box) || work.y1 > box.y0) return;
  page.bar = {left, area[1] - kFromEdge};
  page.bar_across_mm = 100;
  if (with_words) page.words = fmt::format("100 mm: sheet {}", sheet + 1);
}

}  // namespace

Result<std::string> artwork_sheet_pdf(const Artwork& artwork, const std::string& lines,
                                      const Plan& plan, std::size_t sheet,
                                      const PrintPageOptions& options) {
  const PlannedSheet& planned = plan.sheets[sheet];
  ArtworkPage page;
  page.size_mm = options.page_mm.value_or(planned.area_mm);
  if (auto fits = check_page(page.size_mm, planned.area_mm); !fits)
    return tl::unexpected(fits.error());
  const auto raster = printed_sheet(artwork, plan, sheet, options.pixel_mm, options.trapping);
  if (!raster) return tl::unexpected(raster.error());
  page.stretch = stretch_of(options);
  page.image = lines.empty() ? &raster->image : nullptr;
  page.pixel_mm = options.pixel_mm;
  page.svg = lines_on_sheet(lines, plan, sheet);
  page.svg_mm = planned.area_mm;
  if (planned.registration) page.marks = mark_boxes(*planned.registration);
  add_bar(page, *raster, planned.area_mm, plan, sheet, options.words);
  std::vector<ArtworkPage> pages{page};
  ColourImage behind;
  if (options.back) {
    behind = mirrored(raster->image);
    ArtworkPage other;
    other.size_mm = page.size_mm;
    other.stretch = page.stretch;
    other.image = &behind;
    // The sheet's right edge is the left one of the page behind it, whose right part may be empty.
    other.pixel_mm = options.pixel_mm;
    other.shift_mm = page.size_mm[0] - static_cast<double>(behind.width) * options.pixel_mm;
    pages.push_back(other);
  }
  return pdf_of_artwork(pages, fmt::format("{}: sheet {}", plan.name, sheet + 1));
}

Result<std::string> scale_page_pdf(const PrintPageOptions& options) {
  ArtworkPage page;
  page.size_mm = options.page_mm.value_or(std::array<double, 2>{148, 148});
  page.stretch = stretch_of(options);
  page.bar = {20, 125};
  page.bar_across_mm = page.bar_down_mm = 100;
  page.words = "100 mm each: --scale-x and --scale-y take what they measure";
  return pdf_of_artwork(std::vector<ArtworkPage>{page}, "scale");
}

}  // namespace popcut
