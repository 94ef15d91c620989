// SPDX-License-Identifier: MIT
#include "daemon/pictures/drawing.hpp"

namespace popcut::pictures {

Result<Drawing> read_drawing(std::string_view svg) {
  const Graphics& g = graphics();
  GError* error = nullptr;
  using Stream = std::unique_ptr<GInputStream, Release>;
  const Stream stream(
      g.g_memory_input_stream_new_from_data(svg.data(), static_cast<gssize>(svg.size()), nullptr));
  Drawing drawing;
  // Unlimited: what popcut writes itself may be larger than what a browser should take.
  drawing.handle.reset(g.rsvg_handle_new_from_stream_sync(
      stream.get(), nullptr, RSVG_HANDLE_FLAG_UNLIMITED, nullptr, &error));
  if (!drawing.handle) return cannot(error);
  gboolean has_box = FALSE;
  RsvgRectangle box{};
  g.rsvg_handle_get_intrinsic_dimensions(drawing.handle.get(), nullptr, nullptr, nullptr, nullptr,
                                         &has_box, &box);
  if (has_box == FALSE || !(box.width > 0) || !(box.height > 0)) return cannot("it has no viewBox");
  drawing.width = box.width;
  drawing.height = box.height;
  return drawing;
}

Result<void> draw(const Drawing& drawing, cairo_t* cairo, const RsvgRectangle& where) {
  const Graphics& g = graphics();
  GError* error = nullptr;
  if (g.rsvg_handle_render_document(drawing.handle.get(), cairo, &where, &error) == FALSE)
    return cannot(error);
  if (const auto status = g.cairo_status(cairo); status != CAIRO_STATUS_SUCCESS)
    return cannot(g.cairo_status_to_string(status));
  return {};
}

}  // namespace popcut::pictures
