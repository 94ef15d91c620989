// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>

namespace popcut {

/// What a file is that popcut reads nowhere, or not where it was given, by its first bytes: "a PNG
/// picture", "a STEP model". Empty: something else, so that the reader that was chosen says what is
/// wrong. STL, OBJ, glTF and JSON are something else.
[[nodiscard]] std::string_view foreign_kind(std::string_view bytes);

/// What a file is that is no drawing popcut reads, and what to do with it, by its first bytes or
/// the end of its name: "is a PDF document; make an SVG of it: pdftocairo -svg FILE drawing.svg".
/// Empty: something else.
[[nodiscard]] std::string foreign_advice(std::string_view bytes, std::string_view file_name = {});

}  // namespace popcut
