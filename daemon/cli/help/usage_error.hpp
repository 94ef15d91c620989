// SPDX-License-Identifier: MIT
#pragma once

#include <optional>

#include "core/result.hpp"

namespace CLI {
class App;
class ParseError;
}  // namespace CLI

namespace popcut::cli {

/// The one line for a command line that CLI11 refused: the option or word that is wrong, and what
/// would be right.
[[nodiscard]] Error usage_error(const CLI::App& app, const CLI::ParseError& refused);

/// Why there is no help to print: `--help` after a word that is not a command. Other words too many
/// do not matter there.
[[nodiscard]] std::optional<Error> help_error(const CLI::App& app);

}  // namespace popcut::cli
