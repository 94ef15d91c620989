// SPDX-License-Identifier: MIT
#include "daemon/pictures/pdf.hpp"

#include <algorithm>
#include <cstdint>
#include <memory>

#include <cairo-pdf.h>
#include <fontconfig/fontconfig.h>

#include "core/text/utf8.hpp"
#include "daemon/pictures/drawing.hpp"

namespace popcut {
namespace {

using namespace pictures;

constexpr double kPointsPerMm = 72.0 / 25.4;

cairo_status_t append(void* bytes, const unsigned char* data, unsigned size) {
  static_cast<std::string*>(bytes)->append(reinterpret_cast<const char*>(data), size);
  return CAIRO_STATUS_SUCCESS;
}

Result<void> add_page(const PrintedPage& page, cairo_surface_t* surface, cairo_t* cairo) {
  const auto drawing = read_drawing(page.svg);
  if (!drawing) return tl::unexpected(drawing.error());
  const double width = page.width_mm * kPointsPerMm, height = page.height_mm * kPointsPerMm,
               margin = page.margin_mm * kPointsPerMm;
  cairo_pdf_surface_set_size(surface, width, height);
  const RsvgRectangle where{margin, margin, width - 2 * margin, height - 2 * margin};
  if (auto drawn = draw(*drawing, cairo, where); !drawn) return drawn;
  cairo_show_page(cairo);
  return {};
}

bool needs_no_font(std::uint32_t letter) {
  return letter <= 0x20 || letter == 0x7F || (letter >= 0x200B && letter <= 0x200F) ||
         (letter >= 0xFE00 && letter <= 0xFE0F);  // spaces, joiners, variants
}

bool has_font(std::uint32_t letter) {
  struct Done {
    void operator()(FcCharSet* set) const { FcCharSetDestroy(set); }
    void operator()(FcPattern* pattern) const { FcPatternDestroy(pattern); }
    void operator()(FcObjectSet* set) const { FcObjectSetDestroy(set); }
    void operator()(FcFontSet* set) const { FcFontSetDestroy(set); }
  };
  const std::unique_ptr<FcCharSet, Done> letters(FcCharSetCreate());
  FcCharSetAddChar(letters.get(), letter);
  const std::unique_ptr<FcPattern, Done> wanted(FcPatternCreate());
  FcPatternAddCharSet(wanted.get(), FC_CHARSET, letters.get());
  const std::unique_ptr<FcObjectSet, Done> nothing(FcObjectSetCreate());
  const std::unique_ptr<FcFontSet, Done> fonts(FcFontList(nullptr, wanted.get(), nothing.get()));
  return fonts && fonts->nfont > 0;
}

}  // namespace

Result<std::string> pdf_of_pages(std::span<const PrintedPage> pages, std::string_view title) {
  std::string bytes;
  {
    const Surface surface(cairo_pdf_surface_create_for_stream(append, &bytes, 1, 1));
    cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_TITLE,
                                   page_name(std::string(title)).c_str());
    cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_CREATOR, "popcut");
    // No date: the same pages give the same bytes.
    cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_CREATE_DATE, "");
    const Context cairo(cairo_create(surface.get()));
    for (const PrintedPage& page : pages)
      if (auto added = add_page(page, surface.get(), cairo.get()); !added)
        return tl::unexpected(added.error());
    cairo_surface_finish(surface.get());
    if (const auto status = cairo_surface_status(surface.get()); status != CAIRO_STATUS_SUCCESS)
      return cannot(cairo_status_to_string(status));
  }
  return bytes;
}

std::string letters_without_font(std::string_view text) {
  std::string missing;
  for (std::size_t at = 0; at < text.size();) {
    const CodePoint found = code_point(text, at);
    const std::uint32_t letter = found.value;
    const std::string_view bytes = text.substr(at, std::max<std::size_t>(1, found.length));
    at += bytes.size();
    if (found.length == 0 || needs_no_font(letter) || missing.find(bytes) != std::string::npos ||
        has_font(letter))
      continue;
    missing += bytes;
  }
  return missing;
}

std::optional<Warning> font_warning(std::string_view name, std::string_view file) {
  const std::string letters = letters_without_font(name);
  if (letters.empty()) return std::nullopt;
  return Warning{
      .code = "no_font",
      .message = fmt::format("no font of this computer has \"{}\", so {} shows boxes for "
                             "it; install one, such as fonts-noto or fonts-noto-cjk",
                             letters, file)};
}

}  // namespace popcut
