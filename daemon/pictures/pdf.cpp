// SPDX-License-Identifier: MIT
#include "daemon/pictures/pdf.hpp"

#include <algorithm>
#include <cstdint>
#include <memory>

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
  graphics().cairo_pdf_surface_set_size(surface, width, height);
  const RsvgRectangle where{margin, margin, width - 2 * margin, height - 2 * margin};
  if (auto drawn = draw(*drawing, cairo, where); !drawn) return drawn;
  graphics().cairo_show_page(cairo);
  return {};
}

bool needs_no_font(std::uint32_t letter) {
  return letter <= 0x20 || letter == 0x7F || (letter >= 0x200B && letter <= 0x200F) ||
         (letter >= 0xFE00 && letter <= 0xFE0F);  // spaces, joiners, variants
}

bool has_font(std::uint32_t letter) {
  struct Done {
    void operator()(FcCharSet* set) const { graphics().FcCharSetDestroy(set); }
    void operator()(FcPattern* pattern) const { graphics().FcPatternDestroy(pattern); }
    void operator()(FcObjectSet* set) const { graphics().FcObjectSetDestroy(set); }
    void operator()(FcFontSet* set) const { graphics().FcFontSetDestroy(set); }
  };
  const Graphics& g = graphics();
  const std::unique_ptr<FcCharSet, Done> letters(g.FcCharSetCreate());
  g.FcCharSetAddChar(letters.get(), letter);
  const std::unique_ptr<FcPattern, Done> wanted(g.FcPatternCreate());
  g.FcPatternAddCharSet(wanted.get(), FC_CHARSET, letters.get());
  const std::unique_ptr<FcObjectSet, Done> nothing(g.FcObjectSetCreate());
  const std::unique_ptr<FcFontSet, Done> fonts(g.FcFontList(nullptr, wanted.get(), nothing.get()));
  return fonts && fonts->nfont > 0;
}

}  // namespace

Result<std::string> pdf_of_pages(std::span<const PrintedPage> pages, std::string_view title) {
  if (auto loaded = load_graphics(); !loaded) return tl::unexpected(loaded.error());
  const Graphics& g = graphics();
  std::string bytes;
  {
    const Surface surface(g.cairo_pdf_surface_create_for_stream(append, &bytes, 1, 1));
    g.cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_TITLE,
                                     page_name(std::string(title)).c_str());
    g.cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_CREATOR, "popcut");
    // No date: the same pages give the same bytes.
    g.cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_CREATE_DATE, "");
    const Context cairo(g.cairo_create(surface.get()));
    for (const PrintedPage& page : pages)
      if (auto added = add_page(page, surface.get(), cairo.get()); !added)
        return tl::unexpected(added.error());
    g.cairo_surface_finish(surface.get());
    if (const auto status = g.cairo_surface_status(surface.get()); status != CAIRO_STATUS_SUCCESS)
      return cannot(g.cairo_status_to_string(status));
  }
  return bytes;
}

std::string letters_without_font(std::string_view text) {
  std::string missing;
  if (!load_graphics()) return missing;  // the picture itself says why
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
