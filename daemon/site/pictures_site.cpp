// SPDX-License-Identifier: MIT
// Part of daemon/pictures/pdf_page.hpp. What a browser's engine does not do: it reads no PDF and
// has no fonts.
#include "daemon/pictures/pdf_page.hpp"

#include "daemon/pictures/pdf.hpp"

namespace popcut {
namespace pictures {

bool is_pdf(std::string_view bytes) { return bytes.substr(0, 5) == "%PDF-"; }

Result<PdfPage> pdf_page(std::string_view, std::uint64_t) {
  return fail(ErrorKind::Malformed, "",
              "is a PDF, which popcut reads only where it is installed; save the drawing as SVG or "
              "DXF");
}

}  // namespace pictures

}  // namespace popcut
