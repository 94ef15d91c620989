// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "core/print/pages.hpp"
#include "core/result.hpp"
#include "core/warning.hpp"

namespace popcut {

/// Pages as a PDF (librsvg and cairo): lines stay lines, and the letters that are used are
/// embedded. The same pages give the same bytes, as long as the libraries and fonts are the same.
///
/// @retval Internal  the libraries cannot draw it; the detail is theirs
[[nodiscard]] Result<std::string> pdf_of_pages(std::span<const PrintedPage> pages,
                                               std::string_view title);

/// The letters of `text` that no font of this computer has, each once, in the order of the text.
/// They are printed as empty boxes.
[[nodiscard]] std::string letters_without_font(std::string_view text);

/// What to say of a name with such letters in a file; none if there are none.
[[nodiscard]] std::optional<Warning> font_warning(std::string_view name, std::string_view file);

}  // namespace popcut
