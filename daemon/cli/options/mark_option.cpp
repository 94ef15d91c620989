// SPDX-License-Identifier: MIT
#include "daemon/cli/options/mark_option.hpp"

#include <CLI/CLI.hpp>

namespace popcut::cli {

void add_mark_options(CLI::App& command, MarkWords& option) {
  command.add_flag("--marks", option.wanted,
                   "The sheet is printed with registration marks, which the cutter searches first");
  command
      .add_option("--mark-form", option.form,
                  "What TB51 tells the cutter: arm (length, TB53 thickness) or line (the reverse)")
      ->option_text("WORD [arm]");
}

}  // namespace popcut::cli
