// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace popcut {

/// `text` in one line for a terminal: control characters become blanks, those of UTF-8 too (U+0080
/// to U+009F, which some terminals take for escape sequences). What is no UTF-8 stays as it is.
[[nodiscard]] std::string shown_text(std::string text);

}  // namespace popcut
