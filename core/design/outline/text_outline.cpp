// SPDX-License-Identifier: MIT
#include "core/design/outline/text_outline.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>

#include <ft2build.h>
#include FT_FREETYPE_H
#include FT_OUTLINE_H
#include FT_TRUETYPE_TABLES_H
#include <fmt/format.h>
#include <hb.h>

#include "core/text/utf8.hpp"

namespace popcut {
namespace {

constexpr double kStray = 1.0 / 500.0;  // of the height of capitals

struct Done {
  void operator()(FT_Library library) const { FT_Done_FreeType(library); }
  void operator()(FT_Face face) const { FT_Done_Face(face); }
  void operator()(hb_blob_t* blob) const { hb_blob_destroy(blob); }
  void operator()(hb_face_t* face) const { hb_face_destroy(face); }
  void operator()(hb_font_t* font) const { hb_font_destroy(font); }
  void operator()(hb_buffer_t* buffer) const { hb_buffer_destroy(buffer); }
};
using Library = std::unique_ptr<FT_LibraryRec_, Done>;
using Face = std::unique_ptr<FT_FaceRec_, Done>;

/// Chords of outlines, in the font's own units.
class Chords {
 public:
  Chords(double stray, std::vector<Ring>& out) : stray_(stray), out_(out) {}

  /// @return false if the outline is broken
  bool add(FT_Outline& outline, const Vec2& place) {
    place_ = place;
    FT_Outline_Funcs calls{};
    calls.move_to = [](const FT_Vector* to, void* self) {
      auto& chords = *static_cast<Chords*>(self);
      chords.out_.push_back({chords.at(*to)});
      return 0;
    };
    calls.line_to = [](const FT_Vector* to, void* self) {
      auto& chords = *static_cast<Chords*>(self);
      chords.out_.back().push_back(chords.at(*to));
      return 0;
    };
    calls.conic_to = [](const FT_Vector* by, const FT_Vector* to, void* self) {
      auto& chords = *static_cast<Chords*>(self);
      const Vec2 a = chords.out_.back().back(), b = chords.at(*by), c = chords.at(*to);
      chords.curve(a, a + 2.0 / 3.0 * (b - a), c + 2.0 / 3.0 * (b - c), c);
      return 0;
    };
    calls.cubic_to = [](const FT_Vector* by, const FT_Vector* then, const FT_Vector* to,
                        void* self) {
      auto& chords = *static_cast<Chords*>(self);
      chords.curve(chords.out_.back().back(), chords.at(*by), chords.at(*then), chords.at(*to));
      return 0;
    };
    return FT_Outline_Decompose(&outline, &calls, this) == 0;
  }

 private:
  [[nodiscard]] Vec2 at(const FT_Vector& p) const {
    return place_ + Vec2(static_cast<double>(p.x), static_cast<double>(p.y));
  }

  void curve(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
    // A chord of 1/n strays by at most 3/4 of the largest second difference over n^2.
    const double bend = std::max((a - 2.0 * b + c).norm(), (b - 2.0 * c + d).norm());
    const int n = std::clamp(static_cast<int>(std::ceil(std::sqrt(0.75 * bend / stray_))), 1, 64);
    for (int k = 1; k <= n; ++k) {
      const double t = static_cast<double>(k) / n, s = 1.0 - t;
      out_.back().push_back(s * s * s * a + 3.0 * s * s * t * b + 3.0 * s * t * t * c +
                            t * t * t * d);
    }
  }

  double stray_;
  std::vector<Ring>& out_;
  Vec2 place_;
};

/// Height of the capitals in the font's units: as the font says, else that of an H, else of all.
double height_of_capitals(FT_Face face) {
  const auto* os2 = static_cast<const TT_OS2*>(FT_Get_Sfnt_Table(face, FT_SFNT_OS2));
  if (os2 != nullptr && os2->version != 0xFFFF && os2->version >= 2 && os2->sCapHeight > 0)
    return os2->sCapHeight;
  if (FT_Load_Char(face, 'H', FT_LOAD_NO_SCALE) == 0 && face->glyph->metrics.horiBearingY > 0)
    return static_cast<double>(face->glyph->metrics.horiBearingY);
  return face->ascender > 0 ? face->ascender : face->units_per_EM;
}

std::string letter_name(std::uint32_t code, const std::string& text, std::size_t at) {
  const std::string_view letter = std::string_view(text).substr(at, code_point(text, at).length);
  return fmt::format("\"{}\" (U+{:04X})", shown_text(letter), code);
}

/// What text may not hold, before a font is looked at.
Result<void> check_text(const std::string& text) {
  const auto refuse = [](std::string what) {
    return fail(ErrorKind::OutOfRange, "text", std::move(what));
  };
  if (!is_utf8(text)) return refuse("is not valid UTF-8");
  if (has_controls(text)) return refuse("has a line break or control character; give one line");
  const std::size_t letters = code_points(text);
  if (letters > kMostLetters)
    return refuse(fmt::format("has {} letters; must have at most {}", letters, kMostLetters));
  hb_unicode_funcs_t* unicode = hb_unicode_funcs_get_default();
  bool right = false, left = false, digits = false;
  for (std::size_t at = 0; at < text.size(); at += code_point(text, at).length) {
    const auto code = static_cast<hb_codepoint_t>(code_point(text, at).value);
    const hb_script_t script = hb_unicode_script(unicode, code);
    if (hb_unicode_general_category(unicode, code) == HB_UNICODE_GENERAL_CATEGORY_DECIMAL_NUMBER)
      digits = true;
    if (script == HB_SCRIPT_COMMON || script == HB_SCRIPT_INHERITED) continue;
    (hb_script_get_horizontal_direction(script) == HB_DIRECTION_RTL ? left : right) = true;
  }
  if (left && (right || digits))
    return refuse(
        "is written in both directions; give letters of one direction, without digits "
        "among letters that run from right to left");
  return {};
}

}  // namespace

Result<std::vector<Area>> text_areas(const std::string& text, std::string_view font,
                                     double height) {
  if (auto fine = check_text(text); !fine) return tl::unexpected(fine.error());
  FT_Library opened{};
  if (FT_Init_FreeType(&opened) != 0)
    return fail(ErrorKind::Internal, "font", "FreeType cannot begin");
  const Library library(opened);
  FT_Face read{};
  if (font.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()) ||
      FT_New_Memory_Face(library.get(), reinterpret_cast<const FT_Byte*>(font.data()),
                         static_cast<FT_Long>(font.size()), 0, &read) != 0)
    return fail(ErrorKind::Malformed, "font",
                "is no font that can be read; give a TrueType or OpenType file (.ttf, .otf)");
  const Face face(read);
  if (!FT_IS_SCALABLE(face.get()) || face->units_per_EM == 0)
    return fail(ErrorKind::Malformed, "font",
                "has pixels, not outlines; give a TrueType or OpenType file with outlines");

  const std::unique_ptr<hb_blob_t, Done> blob(hb_blob_create(
      font.data(), static_cast<unsigned>(font.size()), HB_MEMORY_MODE_READONLY, nullptr, nullptr));
  const std::unique_ptr<hb_face_t, Done> tables(hb_face_create(blob.get(), 0));
  const std::unique_ptr<hb_font_t, Done> shaper(hb_font_create(tables.get()));
  hb_font_set_scale(shaper.get(), face->units_per_EM, face->units_per_EM);
  const std::unique_ptr<hb_buffer_t, Done> buffer(hb_buffer_create());
  hb_buffer_add_utf8(buffer.get(), text.data(), static_cast<int>(text.size()), 0,
                     static_cast<int>(text.size()));
  hb_buffer_guess_segment_properties(buffer.get());
  hb_shape(shaper.get(), buffer.get(), nullptr, 0);
  unsigned count = 0;
  const hb_glyph_info_t* glyphs = hb_buffer_get_glyph_infos(buffer.get(), &count);
  const hb_glyph_position_t* places = hb_buffer_get_glyph_positions(buffer.get(), nullptr);

  const double capitals = height_of_capitals(face.get());
  std::vector<Ring> rings;
  Chords chords(kStray * capitals, rings);
  Vec2 pen(0.0, 0.0);
  for (unsigned k = 0; k < count; ++k) {
    const std::size_t at = glyphs[k].cluster;
    if (glyphs[k].codepoint == 0) {
      const auto code = static_cast<std::uint32_t>(code_point(text, at).value);
      return fail(ErrorKind::OutOfRange, "text",
                  fmt::format("the font has no {}; give a font that has it with \"font\"",
                              letter_name(code, text, at)));
    }
    if (FT_Load_Glyph(face.get(), glyphs[k].codepoint, FT_LOAD_NO_SCALE) != 0 ||
        face->glyph->format != FT_GLYPH_FORMAT_OUTLINE ||
        !chords.add(face->glyph->outline, pen + Vec2(places[k].x_offset, places[k].y_offset)))
      return fail(ErrorKind::Malformed, "font",
                  fmt::format("has no outline for {}; give another font",
                              letter_name(code_point(text, at).value, text, at)));
    pen += Vec2(places[k].x_advance, places[k].y_advance);
  }

  Eigen::AlignedBox2d box;
  for (const Ring& ring : rings)
    for (const Vec2& p : ring) box.extend(p);
  if (box.isEmpty())
    return fail(ErrorKind::OutOfRange, "text", "has no letter to show; give at least one");
  for (Ring& ring : rings)
    for (Vec2& p : ring) p = (p - box.min()) * (height / capitals);
  auto areas = areas_within(rings, FillRule::NonZero);
  if (!areas) return tl::unexpected(within("text", areas.error()));
  return areas;
}

}  // namespace popcut
