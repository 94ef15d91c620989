// SPDX-License-Identifier: MIT
#include "daemon/pictures/artwork_pages.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/plan/marks.hpp"
#include "core/plan/sheet_pieces.hpp"
#include "core/text/svg_document.hpp"
#include "daemon/digest/digest.hpp"
#include "daemon/pictures/artwork_pdf.hpp"
#include "daemon/pictures/image_reader.hpp"
#include "daemon/pictures/png.hpp"

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
  std::string svg;
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
  return svg;
}

/// SVG elements in mm of a page as a document.
std::string document(const std::string& elements, const std::array<double, 2>& page_mm,
                     const PagePoint& shift_mm) {
  return svg_head(fmt::format("width=\"{0:g}mm\" height=\"{1:g}mm\" viewBox=\"0 0 {0:g} {1:g}\"",
                              page_mm[0], page_mm[1])) +
         fmt::format("<g transform=\"translate({} {})\">\n{}</g>\n</svg>\n", shift_mm.x, shift_mm.y,
                     elements);
}

/// Where labels may not stand: marks with what is free around them, and tabs.
std::vector<Box> kept_clear(const Plan& plan, std::size_t sheet) {
  constexpr double kQuiet_mm = 2.0;
  std::vector<Box> out;
  if (const auto& marks = plan.sheets[sheet].registration)
    for (const Box& mark : mark_boxes(*marks))
      out.push_back(
          {mark.x0 - kQuiet_mm, mark.y0 - kQuiet_mm, mark.x1 + kQuiet_mm, mark.y1 + kQuiet_mm});
  for (const PieceMap& piece : pieces_on_sheet(plan, sheet))
    for (std::size_t k = 1; k < piece.polygons.size(); ++k)
      out.push_back(bounds(piece.polygons[k]));
  return out;
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
void add_bar(ArtworkPage& page, const PrintedSheet* raster, const std::array<double, 2>& area,
             const Plan& plan, std::size_t sheet, bool with_words) {
  constexpr double kFromEdge = 10, kHigh = 8;
  const double left = area[0] / 2 - 50, top = area[1] - kFromEdge - 3;
  const Box box{left - 2, top, left + 102, top + kHigh};
  const Box work = bounds(plan.sheets[sheet].path.points);
  if (left < 32 || (raster != nullptr && !is_free(*raster, box)) || work.y1 > box.y0) return;
  page.bar = {left, area[1] - kFromEdge};
  page.bar_across_mm = 100;
  const std::string names = part_names(parts_on_sheet(plan, sheet));
  if (with_words)
    page.words = fmt::format("100 mm: sheet {}{}", sheet + 1, names.empty() ? "" : ", " + names);
}

/// The names of parts beside them, and where tabs go.
std::string names_and_glue(const Plan& plan, std::size_t sheet, std::vector<Box> taken) {
  constexpr double kEdge_mm = 3.0;  // what printers leave white, or most of it
  const auto& area = plan.sheets[sheet].area_mm;
  return part_labels_svg(parts_on_sheet(plan, sheet),
                         {kEdge_mm, kEdge_mm, area[0] - kEdge_mm, area[1] - kEdge_mm},
                         std::move(taken)) +
         glue_marks_svg(plan, sheet);
}

/// Names and where tabs go as a picture, as large as `artwork_sheet_png` says.
Result<std::string> names_png(const Plan& plan, std::size_t sheet, double around_mm,
                              double pixel_mm) {
  const Box work = bounds(plan.sheets[sheet].path.points);
  const std::array<double, 2> size{work.width() + 2 * around_mm, work.height() + 2 * around_mm};
  const std::string ground = fmt::format(
      "<rect x=\"{:.4f}\" y=\"{:.4f}\" width=\"{:.4f}\" height=\"{:.4f}\" "
      "fill=\"#ffffff\"/>\n",
      work.x0 - around_mm, work.y0 - around_mm, size[0], size[1]);
  return png_of_svg(document(ground + names_and_glue(plan, sheet, kept_clear(plan, sheet)), size,
                             {around_mm - work.x0, around_mm - work.y0}),
                    static_cast<int>(std::lround(std::max(size[0], size[1]) / pixel_mm)));
}

}  // namespace

bool is_blank(const Artwork& artwork) { return artwork.frame.pixels() == 0; }

Result<std::string> artwork_sheet_pdf(const Artwork& artwork, const std::string& lines,
                                      const Plan& plan, std::size_t sheet,
                                      const PrintPageOptions& options, const PrintedPage* lined) {
  const PlannedSheet& planned = plan.sheets[sheet];
  const auto& area = planned.area_mm;
  ArtworkPage page;
  const std::array<double, 2> least =
      lined ? std::array<double, 2>{lined->width_mm, lined->height_mm} : area;
  page.size_mm = options.page_mm.value_or(least);
  if (auto fits = check_page(page.size_mm, least); !fits) return tl::unexpected(fits.error());
  std::optional<PrintedSheet> raster;
  if (!is_blank(artwork)) {
    auto made = printed_sheet(artwork, plan, sheet, options.pixel_mm, options.trapping);
    if (!made) return tl::unexpected(made.error());
    raster = std::move(*made);
  }
  page.stretch = stretch_of(options);
  page.image = lines.empty() && raster ? &raster->image : nullptr;
  page.pixel_mm = options.pixel_mm;
  if (lined) page.shift_mm = {kPrintSideMm, kPrintSideMm};
  page.svg_mm = least;
  if (!lines.empty())
    page.svgs.push_back(document(lines_on_sheet(lines, plan, sheet), least, page.shift_mm));
  if (planned.registration) page.marks = mark_boxes(*planned.registration);
  if (lined) {
    page.svgs.push_back(lined->svg);
  } else {
    add_bar(page, raster ? &*raster : nullptr, area, plan, sheet, options.words);
    std::vector<Box> taken = kept_clear(plan, sheet);
    if (page.bar_across_mm > 0)
      taken.push_back(
          {page.bar.x - 2, page.bar.y - 3, page.bar.x + page.bar_across_mm + 2, page.bar.y + 6});
    std::string over = names_and_glue(plan, sheet, std::move(taken));
    if (options.cut_lines) {
      const auto drawn = sheet_lines_svg(plan, sheet, PageGround::Artwork);
      if (!drawn) return tl::unexpected(drawn.error());
      over += *drawn;
    }
    if (!over.empty()) page.svgs.push_back(document(over, least, {}));
  }
  std::vector<ArtworkPage> pages{page};
  ColourImage behind;
  if (options.back && raster) {
    behind = mirrored(raster->image);
    ArtworkPage other;
    other.size_mm = page.size_mm;
    other.stretch = page.stretch;
    other.image = &behind;
    // The paper's right edge is the left one of the page behind it, whose right part may be empty.
    // Both pages are stretched from their left edges.
    other.pixel_mm = options.pixel_mm;
    other.shift_mm = {page.size_mm[0] / page.stretch[0] - page.shift_mm.x -
                          static_cast<double>(behind.width) * options.pixel_mm,
                      page.shift_mm.y};
    pages.push_back(other);
  }
  return pdf_of_artwork(pages, fmt::format("{}: sheet {}", plan.name, sheet + 1));
}

Result<std::string> artwork_sheet_svg(const Artwork& artwork, const std::string& lines,
                                      const Plan& plan, std::size_t sheet,
                                      const PrintPageOptions& options) {
  const PlannedSheet& planned = plan.sheets[sheet];
  std::string print = lines_on_sheet(lines, plan, sheet);
  if (print.empty() && !is_blank(artwork)) {
    const auto raster = printed_sheet(artwork, plan, sheet, options.pixel_mm, options.trapping);
    if (!raster) return tl::unexpected(raster.error());
    const auto png = png_of_image(raster->image);
    if (!png) return tl::unexpected(png.error());
    // Pixels are whole: the last row and column may go past the sheet.
    print = fmt::format(
        "<image x=\"0\" y=\"0\" width=\"{:.4f}\" height=\"{:.4f}\" "
        "preserveAspectRatio=\"none\" href=\"data:image/png;base64,{}\"/>\n",
        static_cast<double>(raster->image.width) * options.pixel_mm,
        static_cast<double>(raster->image.height) * options.pixel_mm, daemon::base64(*png));
  }
  if (planned.registration)
    for (const Box& mark : mark_boxes(*planned.registration))
      print += fmt::format("<rect x=\"{:.4f}\" y=\"{:.4f}\" width=\"{:.4f}\" height=\"{:.4f}\"/>\n",
                           mark.x0, mark.y0, mark.width(), mark.height());
  print += is_blank(artwork) ? names_and_glue(plan, sheet, kept_clear(plan, sheet))
                             : glue_marks_svg(plan, sheet);
  return sheet_svg(planned, page_name(fmt::format("{}: sheet {}", plan.name, sheet + 1)), print);
}

Result<std::string> artwork_sheet_png(const Artwork& artwork, const Plan& plan, std::size_t sheet,
                                      const PrintPageOptions& options) {
  if (is_blank(artwork)) return names_png(plan, sheet, options.trapping.bleed_mm, options.pixel_mm);
  const auto raster = printed_sheet(artwork, plan, sheet, options.pixel_mm, options.trapping);
  if (!raster) return tl::unexpected(raster.error());
  const Box work = bounds(plan.sheets[sheet].path.points);
  const double around = options.trapping.bleed_mm, pixel = options.pixel_mm;
  const ColourImage& from = raster->image;
  const auto count = [&](double mm) {
    return static_cast<std::size_t>(std::ceil((mm + 2 * around) / pixel - 1e-9));
  };
  ColourImage out(count(work.width()), count(work.height()));
  // Pixels are whole: half of what is too much goes to either side.
  const double left = 0.5 * (work.x0 + work.x1) - 0.5 * static_cast<double>(out.width) * pixel;
  const double top = 0.5 * (work.y0 + work.y1) - 0.5 * static_cast<double>(out.height) * pixel;
  for (std::size_t j = 0; j < out.height; ++j)
    for (std::size_t i = 0; i < out.width; ++i) {
      const PagePoint at = raster->frame.in_pixels({left + (static_cast<double>(i) + 0.5) * pixel,
                                                    top + (static_cast<double>(j) + 0.5) * pixel});
      if (at.x < -0.5 || at.y < -0.5 || at.x >= static_cast<double>(from.width) - 0.5 ||
          at.y >= static_cast<double>(from.height) - 0.5)
        continue;
      out.set(i, j, colour_between(from, at.x, at.y));
    }
  return png_of_image(on_paper(out));
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
