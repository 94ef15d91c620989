// SPDX-License-Identifier: MIT
#pragma once

#include "core/result.hpp"

namespace CLI {
class App;
class ParseError;
}  // namespace CLI

namespace popcut::cli {

/// The one line for a command line that CLI11 refused: the option or word that is wrong, and what
/// would be right.
[[nodiscard]] Error usage_error(const CLI::App& app, const CLI::ParseError& refused);

}  // namespace popcut::cli
