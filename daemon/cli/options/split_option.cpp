// SPDX-License-Identifier: MIT
#include "daemon/cli/options/split_option.hpp"

#include <CLI/CLI.hpp>

namespace popcut::cli {
void add_split_options(CLI::App& command, SplitWords& option) {
  command
      .add_option("--seam-x", option.seams_x,
                  "Where a drawing that is too large is to be split, mm from its left edge")
      ->delimiter(',')
      ->option_text("MM,...");
  command.add_option("--seam-y", option.seams_y, "The same from its upper edge")
      ->delimiter(',')
      ->option_text("MM,...");
  command
      .add_option("--labels", option.labels,
                  "What draws ticks and letters on pieces: pen, cut (short cuts), none, or auto "
                  "(the pen where the machine holds one)")
      ->option_text("WORD [auto]");
  command.add_flag("--no-split", option.never,
                   "Refuse a drawing that is too large instead of splitting it");
}

}  // namespace popcut::cli
