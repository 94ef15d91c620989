// SPDX-License-Identifier: MIT
#include "daemon/pictures/artwork_pdf.hpp"

#include <cstdint>
#include <cstring>

#include "core/print/pages.hpp"
#include "daemon/pictures/drawing.hpp"

namespace popcut {
namespace {

using namespace pictures;

constexpr double kPoints = 72.0 / 25.4;  // a mm

cairo_status_t append_bytes(void* bytes, const unsigned char* data, unsigned size) {
  static_cast<std::string*>(bytes)->append(reinterpret_cast<const char*>(data), size);
  return CAIRO_STATUS_SUCCESS;
}

/// The pixels on white paper, as cairo has them.
Surface on_white(const ColourImage& image) {
  const Graphics& g = graphics();
  Surface surface(g.cairo_image_surface_create(CAIRO_FORMAT_RGB24, static_cast<int>(image.width),
                                               static_cast<int>(image.height)));
  unsigned char* const to = g.cairo_image_surface_get_data(surface.get());
  if (to == nullptr) return surface;
  const auto stride = static_cast<std::size_t>(g.cairo_image_surface_get_stride(surface.get()));
  for (std::size_t j = 0; j < image.height; ++j)
    for (std::size_t i = 0; i < image.width; ++i) {
      const std::uint8_t* p = image.at(i, j);
      const auto over = [&](std::size_t k) {
        return static_cast<std::uint32_t>((p[k] * p[3] + 255 * (255 - p[3]) + 127) / 255);
      };
      const std::uint32_t pixel = over(0) << 16 | over(1) << 8 | over(2);
      std::memcpy(to + j * stride + 4 * i, &pixel, 4);
    }
  g.cairo_surface_mark_dirty(surface.get());
  return surface;
}

void add_bars(const ArtworkPage& page, cairo_t* cairo) {
  const Graphics& g = graphics();
  if (!(page.bar_across_mm > 0)) return;
  const auto [x, y] = page.bar;
  g.cairo_set_source_rgb(cairo, 0, 0, 0);
  g.cairo_set_line_width(cairo, 0.3);
  const auto line = [&](double x0, double y0, double x1, double y1) {
    g.cairo_move_to(cairo, x0, y0);
    g.cairo_line_to(cairo, x1, y1);
    g.cairo_stroke(cairo);
  };
  line(x, y, x + page.bar_across_mm, y);
  line(x, y - 1.5, x, y + 1.5);
  line(x + page.bar_across_mm, y - 1.5, x + page.bar_across_mm, y + 1.5);
  if (page.bar_down_mm > 0) {
    line(x, y, x, y - page.bar_down_mm);
    line(x - 1.5, y - page.bar_down_mm, x + 1.5, y - page.bar_down_mm);
  }
  if (page.words.empty()) return;
  g.cairo_select_font_face(cairo, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
  g.cairo_set_font_size(cairo, 2.8);
  g.cairo_move_to(cairo, x + 2, y + 4.2);
  g.cairo_show_text(cairo, page.words.c_str());
}

Result<void> add_artwork(const ArtworkPage& page, cairo_surface_t* surface, cairo_t* cairo) {
  const Graphics& g = graphics();
  g.cairo_pdf_surface_set_size(surface, page.size_mm[0] * kPoints, page.size_mm[1] * kPoints);
  g.cairo_save(cairo);
  g.cairo_scale(cairo, kPoints * page.stretch[0], kPoints * page.stretch[1]);
  if (page.image != nullptr) {
    const Surface pixels = on_white(*page.image);
    if (const auto status = g.cairo_surface_status(pixels.get()); status != CAIRO_STATUS_SUCCESS)
      return cannot(g.cairo_status_to_string(status));
    g.cairo_save(cairo);
    g.cairo_translate(cairo, page.shift_mm.x, page.shift_mm.y);
    g.cairo_scale(cairo, page.pixel_mm, page.pixel_mm);
    g.cairo_set_source_surface(cairo, pixels.get(), 0, 0);
    g.cairo_pattern_set_filter(g.cairo_get_source(cairo), CAIRO_FILTER_NEAREST);
    g.cairo_paint(cairo);
    g.cairo_restore(cairo);
  }
  for (const std::string& svg : page.svgs) {
    const auto drawing = read_drawing(svg);
    if (!drawing) return tl::unexpected(drawing.error());
    const RsvgRectangle where{0, 0, page.svg_mm[0], page.svg_mm[1]};
    if (auto drawn = draw(*drawing, cairo, where); !drawn) return drawn;
  }
  g.cairo_set_source_rgb(cairo, 0, 0, 0);
  for (const Box& mark : page.marks)
    g.cairo_rectangle(cairo, mark.x0, mark.y0, mark.width(), mark.height());
  g.cairo_fill(cairo);
  add_bars(page, cairo);
  g.cairo_restore(cairo);
  g.cairo_show_page(cairo);
  return {};
}

}  // namespace

Result<std::string> pdf_of_artwork(std::span<const ArtworkPage> pages, std::string_view title) {
  if (auto loaded = load_graphics(); !loaded) return tl::unexpected(loaded.error());
  const Graphics& g = graphics();
  std::string bytes;
  {
    const Surface surface(g.cairo_pdf_surface_create_for_stream(append_bytes, &bytes, 1, 1));
    g.cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_TITLE,
                                     page_name(std::string(title)).c_str());
    g.cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_CREATOR, "popcut");
    g.cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_CREATE_DATE, "");
    const Context cairo(g.cairo_create(surface.get()));
    for (const ArtworkPage& page : pages)
      if (auto added = add_artwork(page, surface.get(), cairo.get()); !added)
        return tl::unexpected(added.error());
    g.cairo_surface_finish(surface.get());
    if (const auto status = g.cairo_surface_status(surface.get()); status != CAIRO_STATUS_SUCCESS)
      return cannot(g.cairo_status_to_string(status));
  }
  return bytes;
}

}  // namespace popcut
