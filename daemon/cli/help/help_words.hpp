// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "daemon/cli/parsing/command_line.hpp"

namespace popcut::cli {

/// What a word of the command line is completed to.
enum class WordKind {
  None,     ///< a flag: nothing follows
  Free,     ///< text or a number
  File,     ///< a file or folder
  Words,    ///< one of `words`
  Command,  ///< what the shell command `words[0]` prints, one a line
};

struct OptionWords {
  std::vector<std::string> names;  ///< "-o", "--output"
  std::string help;
  std::string value;  ///< "DIR", "NAME [cameo3]", as the help shows it; empty: a flag
  WordKind kind{};
  std::vector<std::string> words{};
};

struct CommandWords {
  std::string path;     ///< "popcut token create"
  std::string summary;  ///< first line of the help
  std::string text;     ///< all of it
  std::string footer;   ///< what stands under the help
  std::vector<OptionWords> options, positionals;
  std::vector<CommandWords> commands;
};

/// The program's commands and options, without those that are hidden.
[[nodiscard]] CommandWords words_of(const Command& program);

/// The manual page.
[[nodiscard]] std::string manual_page(const CommandWords& program, int section);

}  // namespace popcut::cli
