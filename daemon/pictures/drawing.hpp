// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <string_view>

#include <fmt/format.h>

#include "core/result.hpp"
#include "daemon/pictures/graphics.hpp"

namespace popcut::pictures {

/// Gives back what the libraries own.
struct Release {
  void operator()(cairo_surface_t* owned) const { graphics().cairo_surface_destroy(owned); }
  void operator()(cairo_t* owned) const { graphics().cairo_destroy(owned); }
  void operator()(RsvgHandle* owned) const { graphics().g_object_unref(owned); }
  void operator()(GInputStream* owned) const { graphics().g_object_unref(owned); }
  void operator()(GError* owned) const { graphics().g_error_free(owned); }
};

using Surface = std::unique_ptr<cairo_surface_t, Release>;
using Context = std::unique_ptr<cairo_t, Release>;

/// An SVG drawing that librsvg has read, and its viewBox.
struct Drawing {
  std::unique_ptr<RsvgHandle, Release> handle;
  double width{}, height{};
};

[[nodiscard]] inline tl::unexpected<Error> cannot(std::string_view why) {
  return fail(ErrorKind::Internal, "picture", fmt::format("cannot be drawn: {}", why));
}

[[nodiscard]] inline tl::unexpected<Error> cannot(GError* error) {
  const std::unique_ptr<GError, Release> owned(error);
  return cannot(owned ? owned->message : "librsvg does not say why");
}

/// Reads a drawing; nothing outside of it is read.
///
/// @retval Internal  librsvg cannot read it, or it has no viewBox
[[nodiscard]] Result<Drawing> read_drawing(std::string_view svg);

/// Draws it into a part of the page, as large as fits.
///
/// @retval Internal  librsvg or cairo failed
[[nodiscard]] Result<void> draw(const Drawing& drawing, cairo_t* cairo, const RsvgRectangle& where);

}  // namespace popcut::pictures
