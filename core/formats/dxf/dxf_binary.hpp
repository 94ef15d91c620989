// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "core/result.hpp"

namespace popcut {

/// Whether a file begins as a binary DXF does.
[[nodiscard]] bool is_binary_dxf(std::string_view bytes);

/// A binary DXF (R10 to R2018) as the ASCII DXF of the same groups, two lines a group. The type of
/// a value follows from its group code (DXF reference, "group code value types"). Codes are one
/// byte up to R12, and two from R13 on.
///
/// @retval Malformed   the file ends within a group, or a group code has no type; place is "group
/// N"
/// @retval OutOfRange  the text is longer than `most_bytes`
[[nodiscard]] Result<std::string> ascii_dxf(std::string_view bytes, std::size_t most_bytes);

}  // namespace popcut
