// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.hpp"
#include "core/warning.hpp"

namespace popcut::pictures {

/// A page of a PDF as an SVG drawing of the same size, and what of it is no line to cut.
struct PdfPage {
  std::string svg;
  std::vector<Warning> warnings;
};

/// Whether these are the first bytes of a PDF, or of an Illustrator file that holds one.
[[nodiscard]] bool is_pdf(std::string_view bytes);

/// Loads the library that reads PDF (poppler), at the first call. `pdf_page` calls it by itself; a
/// process that gives up its files calls it before.
///
/// @retval Internal  poppler or one of its functions is missing; the detail names the package
[[nodiscard]] Result<void> load_pdf_reader();

/// Draws a page, from 1, with the layers that the PDF shows. Layers become groups with their names,
/// where there are at most 64. Letters and white areas are left out, and a warning counts them. A
/// page can be hostile: call it in a process of its own that may do nothing else.
///
/// @retval Malformed   it cannot be read (poppler says why), has a password, or is an Illustrator
///                     file without a PDF
/// @retval OutOfRange  there is no such page
/// @retval Internal    poppler or cairo cannot be loaded, or failed
[[nodiscard]] Result<PdfPage> pdf_page(std::string_view pdf, std::uint64_t page);

}  // namespace popcut::pictures
