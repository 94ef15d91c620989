// SPDX-License-Identifier: MIT
#include "daemon/cli/options/knife_option.hpp"

#include <CLI/CLI.hpp>

namespace popcut::cli {
void add_knife_options(CLI::App& command, KnifeWords& option) {
  const auto text = [&](const char* name, std::string& value, const char* help, const char* shown) {
    command.add_option(name, value, help)->option_text(shown);
  };
  text("--folds", option.folds,
       "How folds are made: perforate, score (stylus) or light (cut half through)",
       "WORD [the material's]");
  text("--overcut", option.overcut, "Beyond both ends of closed cuts, mm", "MM [the material's]");
  text("--direction", option.direction, "Which way round closed cuts go: any, cw or ccw",
       "WORD [any]");
  text("--snap", option.snap, "Ends of lines that are one point, mm", "MM [0.05]");
}

}  // namespace popcut::cli
