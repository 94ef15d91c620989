// SPDX-License-Identifier: MIT
#pragma once

#include <sys/types.h>

#include <string>
#include <string_view>
#include <vector>

#include "tests/support/process.hpp"

namespace popcut::testing {

/// A program at a terminal of its own, run in a folder. Its standard output goes to the file `out`
/// there; users' tables are read from `config/popcut` there.
class AtTerminal {
 public:
  AtTerminal(const std::string& program, const std::vector<std::string>& words,
             const TempFolder& folder);
  AtTerminal(const AtTerminal&) = delete;
  AtTerminal& operator=(const AtTerminal&) = delete;
  ~AtTerminal();

  /// Reads the terminal until `words` were shown; false if the program ended, or a minute passed,
  /// without them.
  bool shows(const std::string& words);
  /// Keys, Ctrl-C ("\x03") among them.
  void type(std::string_view words);
  /// Sends it a signal.
  void signal(int number);
  /// Closes the terminal under it.
  void close();
  /// The exit code, once it has ended.
  int ended();
  [[nodiscard]] std::string out() const { return text_of_file(folder_ / "out"); }
  /// What is in `out` once it holds a whole line; empty after a minute without.
  [[nodiscard]] std::string first_line() const;

  std::string shown;

 private:
  bool read_some();
  const TempFolder& folder_;
  int master_{-1};
  pid_t child_{-1};
};

}  // namespace popcut::testing
