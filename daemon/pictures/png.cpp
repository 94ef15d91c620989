// SPDX-License-Identifier: MIT
#include "daemon/pictures/png.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include <cairo.h>
#include <fmt/format.h>
#include <librsvg/rsvg.h>

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

cairo_status_t append(void* png, const unsigned char* bytes, unsigned int count) {
  static_cast<std::string*>(png)->append(reinterpret_cast<const char*>(bytes), count);
  return CAIRO_STATUS_SUCCESS;
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
  std::string png;
  const cairo_status_t status = cairo_surface_write_to_png_stream(surface.get(), append, &png);
  if (status != CAIRO_STATUS_SUCCESS) return cannot(cairo_status_to_string(status));
  return png;
}

}  // namespace popcut
