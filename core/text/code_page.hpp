// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace popcut {

/// Text in a code page as UTF-8. Bytes that the code page does not have become U+FFFD.
///
/// @param name  as files give it: "ANSI_936" and "DOS866" of DXF, or a name of the IANA such as
///              "windows-1251" and "Shift_JIS"
/// @return none if the computer does not know the code page
[[nodiscard]] std::optional<std::string> utf8_of_code_page(std::string_view text,
                                                           std::string_view name);

}  // namespace popcut
