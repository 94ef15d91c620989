// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/result.hpp"
#include "protocol/encode.hpp"

namespace popcut::planning {

/// `sheet-NN.program.json`: what a stored program's bytes are for. {"popcut": 1, "dialect":
/// "gpgl"|"hpgl", "bytes": N, "sha256": "...", "setup": [end, ...], "search": end, "strokes": [end,
/// ...], "dots": [index, ...], "ask_blade": true|false}. Every block begins where the one before it
/// ended; the trailer is the rest.
[[nodiscard]] std::string program_index(const EncodedProgram& program);

/// A stored program, from its index and its bytes. Nothing of either is trusted.
///
/// @retval Malformed   the index is not of its form; place is a JSON pointer
/// @retval OutOfRange  a block is not within the bytes or not after the one before it
/// @retval CheckFailed the bytes are not those the index was written for
[[nodiscard]] Result<EncodedProgram> read_program(std::string_view index, std::string bytes);

/// SHA-256, as 64 hexadecimal digits, over the bytes of all programs one after another, as `cat
/// sheet-*.gpgl | sha256sum`.
[[nodiscard]] std::string sha256_of(const std::vector<EncodedProgram>& programs);

}  // namespace popcut::planning
