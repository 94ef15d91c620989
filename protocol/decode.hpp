// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>

#include "core/result.hpp"
#include "protocol/program.hpp"

namespace popcut {

/// Reads a whole program. Bytes that are not understood are kept as Unknown. If the program ends
/// within a command, that command is Unknown and `truncated` is set. No bytes are an error.
///
/// @retval OutOfRange  more than 2^28 bytes
[[nodiscard]] Result<Program> decode(Dialect dialect, std::span<const std::byte> bytes);

/// The language in which fewer of the first bytes are Unknown; GPGL if both read them equally well.
[[nodiscard]] Dialect guess_dialect(std::span<const std::byte> bytes);

}  // namespace popcut
