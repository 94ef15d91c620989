// SPDX-License-Identifier: MIT
#pragma once

#include <string_view>

namespace popcut {

/// What a file is that popcut reads nowhere, or not where it was given, by its first bytes: "a PNG
/// picture", "a STEP model". Empty: something else, so that the reader that was chosen says what is
/// wrong. STL, OBJ, glTF and JSON are something else.
[[nodiscard]] std::string_view foreign_kind(std::string_view bytes);

}  // namespace popcut
