// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace popcut::cli {

/// How many columns of a terminal a line of UTF-8 takes: none for marks that stand on the letter
/// before, two for the wide characters of East Asia and for pictures, one for all else.
[[nodiscard]] std::size_t columns_of(std::string_view text);

/// Cut to `width` columns; a character of several bytes is never cut through.
[[nodiscard]] std::string fitted(std::string text, std::size_t width);

/// `text` with blanks up to `width` columns, cut there if it is longer.
[[nodiscard]] std::string padded(std::string text, std::size_t width);

/// `line` in lines of at most `width` columns, broken at blanks; all but the first begin with
/// `indent` blanks. A command to type ("popcut ...") is kept in one line where there is room.
[[nodiscard]] std::vector<std::string> wrapped(const std::string& line, std::size_t width,
                                               std::size_t indent);

/// Columns of the terminal behind a descriptor; `otherwise` where none is, or it does not say.
[[nodiscard]] std::size_t terminal_columns(int descriptor, std::size_t otherwise);

}  // namespace popcut::cli
