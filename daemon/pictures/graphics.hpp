// SPDX-License-Identifier: MIT
#pragma once

#include <cairo-pdf.h>
#include <cairo.h>
#include <fontconfig/fontconfig.h>
#include <librsvg/rsvg.h>

#include "daemon/files/late_library.hpp"
#include "daemon/pictures/load_graphics.hpp"

namespace popcut::pictures {

// NOLINTNEXTLINE(bugprone-macro-parentheses): declares the name
#define POPCUT_FUNCTION(name) decltype(&::name) name = function(#name)

/// The functions that draw pictures: librsvg's, and those of cairo, GLib and fontconfig, which
/// librsvg needs itself. Together they bring about 45 libraries. Loading them takes longer than all
/// else of a start of popcut, so they are loaded for the first picture.
struct Graphics : LateLibrary {
  Graphics() : LateLibrary("librsvg-2.so.2", "librsvg2-2") {}

  POPCUT_FUNCTION(rsvg_handle_get_intrinsic_dimensions);
  POPCUT_FUNCTION(rsvg_handle_new_from_stream_sync);
  POPCUT_FUNCTION(rsvg_handle_render_document);

  POPCUT_FUNCTION(cairo_create);
  POPCUT_FUNCTION(cairo_destroy);
  POPCUT_FUNCTION(cairo_fill);
  POPCUT_FUNCTION(cairo_get_source);
  POPCUT_FUNCTION(cairo_image_surface_create);
  POPCUT_FUNCTION(cairo_image_surface_get_data);
  POPCUT_FUNCTION(cairo_image_surface_get_stride);
  POPCUT_FUNCTION(cairo_line_to);
  POPCUT_FUNCTION(cairo_move_to);
  POPCUT_FUNCTION(cairo_paint);
  POPCUT_FUNCTION(cairo_pattern_set_filter);
  POPCUT_FUNCTION(cairo_pdf_surface_create_for_stream);
  POPCUT_FUNCTION(cairo_pdf_surface_set_metadata);
  POPCUT_FUNCTION(cairo_pdf_surface_set_size);
  POPCUT_FUNCTION(cairo_rectangle);
  POPCUT_FUNCTION(cairo_restore);
  POPCUT_FUNCTION(cairo_save);
  POPCUT_FUNCTION(cairo_scale);
  POPCUT_FUNCTION(cairo_select_font_face);
  POPCUT_FUNCTION(cairo_set_font_size);
  POPCUT_FUNCTION(cairo_set_line_width);
  POPCUT_FUNCTION(cairo_set_source_rgb);
  POPCUT_FUNCTION(cairo_set_source_surface);
  POPCUT_FUNCTION(cairo_show_page);
  POPCUT_FUNCTION(cairo_show_text);
  POPCUT_FUNCTION(cairo_status);
  POPCUT_FUNCTION(cairo_status_to_string);
  POPCUT_FUNCTION(cairo_stroke);
  POPCUT_FUNCTION(cairo_surface_destroy);
  POPCUT_FUNCTION(cairo_surface_finish);
  POPCUT_FUNCTION(cairo_surface_flush);
  POPCUT_FUNCTION(cairo_surface_mark_dirty);
  POPCUT_FUNCTION(cairo_surface_status);
  POPCUT_FUNCTION(cairo_translate);

  POPCUT_FUNCTION(g_error_free);
  POPCUT_FUNCTION(g_memory_input_stream_new_from_data);
  POPCUT_FUNCTION(g_object_unref);

  POPCUT_FUNCTION(FcCharSetAddChar);
  POPCUT_FUNCTION(FcCharSetCreate);
  POPCUT_FUNCTION(FcCharSetDestroy);
  POPCUT_FUNCTION(FcFontList);
  POPCUT_FUNCTION(FcFontSetDestroy);
  POPCUT_FUNCTION(FcObjectSetCreate);
  POPCUT_FUNCTION(FcObjectSetDestroy);
  POPCUT_FUNCTION(FcPatternAddCharSet);
  POPCUT_FUNCTION(FcPatternCreate);
  POPCUT_FUNCTION(FcPatternDestroy);
};

#undef POPCUT_FUNCTION

/// The functions, once `load_graphics` has succeeded.
[[nodiscard]] const Graphics& graphics();

}  // namespace popcut::pictures
