// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>

#include "core/result.hpp"
#include "protocol/program.hpp"

namespace popcut {

/// Reads a whole GPGL program. What is not understood is kept as Unknown; what the end cuts off is
/// the last command, Unknown, and `truncated` is set. Bytes alone never make it fail.
///
/// @retval OutOfRange  more bytes than 2^28
[[nodiscard]] Result<Program> decode_gpgl(std::span<const std::byte> bytes);

/// Reads a whole HPGL program, as `decode_gpgl` does.
[[nodiscard]] Result<Program> decode_hpgl(std::span<const std::byte> bytes);

/// Reads a program in either language.
[[nodiscard]] Result<Program> decode(Dialect dialect, std::span<const std::byte> bytes);

/// The language that explains more of the first bytes; GPGL if there is nothing to tell by.
[[nodiscard]] Dialect guess_dialect(std::span<const std::byte> bytes);

}  // namespace popcut
