// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/warning.hpp"

namespace popcut::daemon {

/// Warnings as a JSON array of {code, message, place, spoils}; place is null or has those of sheet,
/// u_mm, v_mm and source that are known. Invalid UTF-8 is replaced.
[[nodiscard]] std::string warnings_json(const std::vector<Warning>& warnings);

/// The warnings of such an array. What is no warning in it is left out, and a code that is none
/// becomes "note".
[[nodiscard]] std::vector<Warning> warnings_from_json(std::string_view json);

/// Leaves at most `most` of them, those that spoil a cut before others, and a last one that says
/// so; texts of at most `longest` bytes.
void shorten(std::vector<Warning>& warnings, std::size_t most, std::size_t longest);

/// The codes of the warnings that may spoil a cut, each once.
[[nodiscard]] std::vector<std::string> spoiling_codes(const std::vector<Warning>& warnings);
/// `codes` without those in `accepted`.
[[nodiscard]] std::vector<std::string> codes_without(std::vector<std::string> codes,
                                                     const std::vector<std::string>& accepted);

}  // namespace popcut::daemon
