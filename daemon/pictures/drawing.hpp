// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <string_view>

#include <cairo.h>
#include <fmt/format.h>
#include <librsvg/rsvg.h>

#include "core/result.hpp"

namespace popcut::pictures {

template <auto release>
struct Release {
  template <typename T>
  void operator()(T* owned) const {
    release(owned);
  }
};

using Surface = std::unique_ptr<cairo_surface_t, Release<cairo_surface_destroy>>;
using Context = std::unique_ptr<cairo_t, Release<cairo_destroy>>;

/// An SVG drawing that librsvg has read, and its viewBox.
struct Drawing {
  std::unique_ptr<RsvgHandle, Release<g_object_unref>> handle;
  double width{}, height{};
};

[[nodiscard]] inline tl::unexpected<Error> cannot(std::string_view why) {
  return fail(ErrorKind::Internal, "picture", fmt::format("cannot be drawn: {}", why));
}

[[nodiscard]] inline tl::unexpected<Error> cannot(GError* error) {
  const std::unique_ptr<GError, Release<g_error_free>> owned(error);
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
