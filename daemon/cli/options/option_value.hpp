// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "daemon/cli/parsing/command_line.hpp"

namespace popcut::cli {

/// What an option's value must be, checked while the command line is read: anything else is a wrong
/// command line (exit 2) whose message has the option, the value and what would be right.
/// A value that is valid in itself and does not fit an input is reported later (exit 3 or 4). Each
/// function returns the option.

/// A whole number from `least` to `most`.
Option whole_number(Option option, std::int64_t least, std::int64_t most);
/// The same for an option that may stand without its value; the command says what is missing.
Option whole_number_if_given(Option option, std::int64_t least, std::int64_t most);
/// A number from `least` to `most` in `unit` ("mm"; "" for a mere number).
Option real_number(Option option, double least, double most, const char* unit = "");
/// One of `words`; the help shows them as "a|b|c", with `usual` in brackets if there is one.
Option one_word(Option option, const std::vector<std::string>& words,
                const std::string& usual = "");

}  // namespace popcut::cli
