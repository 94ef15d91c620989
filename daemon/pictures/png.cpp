// SPDX-License-Identifier: MIT
#include "daemon/pictures/png.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <vector>

#include "daemon/pictures/drawing.hpp"

namespace popcut {
namespace {

using namespace pictures;

/// What cairo has drawn, as a PNG.
Result<std::string> packed(cairo_surface_t* surface, int width, int height) {
  const Graphics& g = graphics();
  g.cairo_surface_flush(surface);
  const unsigned char* const pixels = g.cairo_image_surface_get_data(surface);
  const auto stride = static_cast<std::size_t>(g.cairo_image_surface_get_stride(surface));
  std::vector<unsigned char> rgb(3 * static_cast<std::size_t>(width) *
                                 static_cast<std::size_t>(height));
  unsigned char* to = rgb.data();
  for (int y = 0; y < height; ++y) {
    const unsigned char* from = pixels + static_cast<std::size_t>(y) * stride;
    for (int x = 0; x < width; ++x, from += 4, to += 3) {
      std::uint32_t pixel = 0;  // 0x00RRGGBB in the processor's own order
      std::memcpy(&pixel, from, sizeof pixel);
      to[0] = static_cast<unsigned char>(pixel >> 16);
      to[1] = static_cast<unsigned char>(pixel >> 8);
      to[2] = static_cast<unsigned char>(pixel);
    }
  }
  return png_of_pixels(rgb, width, height);
}

}  // namespace

Result<std::string> png_of_svg(std::string_view svg, int largest_px) {
  if (auto loaded = load_graphics(); !loaded) return tl::unexpected(loaded.error());
  const Graphics& g = graphics();
  const auto drawing = read_drawing(svg);
  if (!drawing) return tl::unexpected(drawing.error());
  const double scale = largest_px / std::max(drawing->width, drawing->height);
  const int width = std::max(1, static_cast<int>(std::lround(drawing->width * scale)));
  const int height = std::max(1, static_cast<int>(std::lround(drawing->height * scale)));
  const Surface surface(g.cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height));
  const Context cairo(g.cairo_create(surface.get()));
  g.cairo_set_source_rgb(cairo.get(), 1, 1, 1);
  g.cairo_paint(cairo.get());
  const RsvgRectangle page{0, 0, static_cast<double>(width), static_cast<double>(height)};
  if (auto drawn = draw(*drawing, cairo.get(), page); !drawn) return tl::unexpected(drawn.error());
  return packed(surface.get(), width, height);
}

}  // namespace popcut
