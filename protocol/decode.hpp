// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>
#include <string>

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

/// What bytes are that are no program popcut sends, and what to do: G-code, a print job, or an HPGL
/// program that begins with the settings of a serial line. Empty: none of these.
[[nodiscard]] std::string foreign_program(std::span<const std::byte> bytes);

}  // namespace popcut
