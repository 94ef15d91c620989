// SPDX-License-Identifier: MIT
#include "daemon/pictures/png.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <memory>
#include <vector>

#include <cairo.h>
#include <fmt/format.h>
#include <librsvg/rsvg.h>
#include <png.h>

namespace popcut {
namespace {

template <auto release>
struct Release {
  template <typename T>
  void operator()(T* owned) const {
    release(owned);
  }
};

tl::unexpected<Error> cannot(std::string_view why) {
  return fail(ErrorKind::Internal, "picture", fmt::format("cannot be drawn: {}", why));
}

tl::unexpected<Error> cannot(GError* error) {
  const std::unique_ptr<GError, Release<g_error_free>> owned(error);
  return cannot(owned ? owned->message : "librsvg does not say why");
}

/// Compressed quickly: drawings are small anyway, and a design should not wait for its pictures.
Result<std::string> packed(cairo_surface_t* surface, int width, int height) {
  cairo_surface_flush(surface);
  const unsigned char* const pixels = cairo_image_surface_get_data(surface);
  const auto stride = static_cast<std::size_t>(cairo_image_surface_get_stride(surface));
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
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(width), image.height = static_cast<png_uint_32>(height);
  image.format = PNG_FORMAT_RGB;
  image.flags = PNG_IMAGE_FLAG_FAST;
  std::string png(PNG_IMAGE_PNG_SIZE_MAX(image), '\0');
  png_alloc_size_t size = png.size();
  if (png_image_write_to_memory(&image, png.data(), &size, 0, rgb.data(), 0, nullptr) == 0)
    return cannot(image.message);
  png.resize(size);
  return png;
}

}  // namespace

Result<std::string> png_of_svg(std::string_view svg, int largest_px) {
  GError* error = nullptr;
  using Stream = std::unique_ptr<GInputStream, Release<g_object_unref>>;
  const Stream stream(
      g_memory_input_stream_new_from_data(svg.data(), static_cast<gssize>(svg.size()), nullptr));
  // Unlimited: what popcut writes itself may be larger than what a browser should take.
  const std::unique_ptr<RsvgHandle, Release<g_object_unref>> handle(
      rsvg_handle_new_from_stream_sync(stream.get(), nullptr, RSVG_HANDLE_FLAG_UNLIMITED, nullptr,
                                       &error));
  if (!handle) return cannot(error);
  gboolean has_box = FALSE;
  RsvgRectangle box{};
  rsvg_handle_get_intrinsic_dimensions(handle.get(), nullptr, nullptr, nullptr, nullptr, &has_box,
                                       &box);
  if (has_box == FALSE || !(box.width > 0) || !(box.height > 0)) return cannot("it has no viewBox");
  const double scale = largest_px / std::max(box.width, box.height);
  const int width = std::max(1, static_cast<int>(std::lround(box.width * scale)));
  const int height = std::max(1, static_cast<int>(std::lround(box.height * scale)));
  const std::unique_ptr<cairo_surface_t, Release<cairo_surface_destroy>> surface(
      cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height));
  const std::unique_ptr<cairo_t, Release<cairo_destroy>> cairo(cairo_create(surface.get()));
  cairo_set_source_rgb(cairo.get(), 1, 1, 1);
  cairo_paint(cairo.get());
  const RsvgRectangle page{0, 0, static_cast<double>(width), static_cast<double>(height)};
  if (rsvg_handle_render_document(handle.get(), cairo.get(), &page, &error) == FALSE)
    return cannot(error);
  if (const auto status = cairo_status(cairo.get()); status != CAIRO_STATUS_SUCCESS)
    return cannot(cairo_status_to_string(status));
  return packed(surface.get(), width, height);
}

}  // namespace popcut
