// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace popcut::cli {

/// What an option's value must be, checked while the command line is read: anything else is a wrong
/// command line (exit 2) whose message has the option, the value and what would be right.
/// A value that is valid in itself and does not fit an input is reported later (exit 3 or 4). Each
/// function returns the option.

/// Whatever `fault_of` finds no fault with: it returns "" or "is "x"; give ...".
CLI::Option* checked(CLI::Option* option, std::function<std::string(const std::string&)> fault_of);

/// A whole number from `least` to `most`.
CLI::Option* whole_number(CLI::Option* option, std::int64_t least, std::int64_t most);
/// The same for an option that may stand without its value; the command says what is missing.
CLI::Option* whole_number_if_given(CLI::Option* option, std::int64_t least, std::int64_t most);
/// A number from `least` to `most` in `unit` ("mm"; "" for a mere number).
CLI::Option* real_number(CLI::Option* option, double least, double most, const char* unit = "");
/// One of `words`; the help shows them as "a|b|c", with `usual` in brackets if there is one.
CLI::Option* one_word(CLI::Option* option, const std::vector<std::string>& words,
                      const std::string& usual = "");
/// Every text and file name of `command` and of the commands below it must have something in it: an
/// empty word is mostly a variable of a script that was not set, and must not arm another job.
/// Those that may stand without a value are left as they are, and so is the command `but`.
void refuse_empty(CLI::App& command, const std::string& but);

}  // namespace popcut::cli
