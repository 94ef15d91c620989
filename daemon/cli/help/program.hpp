// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "core/result.hpp"
#include "daemon/cli/parsing/command_line.hpp"

namespace popcut::cli {

/// A program and its command line.
class Program {
 public:
  /// @param version  what `--version` prints
  Program(const std::string& name, const std::string& purpose, const std::string& footer,
          const std::string& version);
  ~Program();
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  /// The program as a command, to which options and commands are added.
  [[nodiscard]] Command command() const { return Command(*app_); }
  /// Its help lists the commands in a line each and wraps text to the terminal. Options of the
  /// program may stand after a command, too.
  void has_commands();

  /// Every text and file name of every command must have something in it: an empty word is mostly a
  /// variable of a script that was not set, and must not arm another job. Options that may stand
  /// without a value are left as they are, and so is the command `but`.
  void refuse_empty_values(const std::string& but);

  /// Reads the words of the command line into the targets of the options, and calls the work of the
  /// commands that were chosen.
  ///
  /// @return what `--help` or `--version` shall print; nothing: the program goes on
  /// @retval Usage  a word is wrong
  [[nodiscard]] Result<std::optional<std::string>> read(int argc, const char* const* argv);
  /// The error of a command line that names no command.
  [[nodiscard]] Error no_command() const;

 private:
  std::unique_ptr<CLI::App> app_;
};

}  // namespace popcut::cli
