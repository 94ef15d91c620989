// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "core/result.hpp"
#include "daemon/cli/parsing/command_line.hpp"

namespace popcut::cli {

/// Completions and manual pages, made from a program's own help, so that they say what it does.
///
/// @param kind  "bash", "zsh", "fish" or "man"
/// @param section  of the manual
/// @retval Usage  no such kind
[[nodiscard]] Result<std::string> help_page(const Command& program, const std::string& kind,
                                            int section);
[[nodiscard]] const std::vector<std::string>& help_page_kinds();

}  // namespace popcut::cli
