// SPDX-License-Identifier: MIT
#include "daemon/cli/mark_option.hpp"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

namespace popcut::cli {

void add_mark_options(CLI::App& command, MarkOption& option) {
  command.add_flag("--marks", option.wanted,
                   "The sheet is printed with registration marks, which the cutter searches first");
  command
      .add_option("--mark-form", option.form,
                  "What TB51 tells the cutter: arm (length, TB53 thickness) or line (the reverse)")
      ->option_text("WORD [arm]");
}

Result<std::optional<MarkLayout>> read_mark_option(const MarkOption& option, const Machine& machine,
                                                   std::array<double, 2> area_mm) {
  if (option.form != "arm" && option.form != "line")
    return fail(ErrorKind::Usage, "--mark-form",
                fmt::format("{} is not known; arm or line", option.form));
  if (!option.wanted) return std::nullopt;
  auto marks = marks_for(area_mm);
  if (!marks) return tl::unexpected(marks.error());
  marks->arm_first = option.form == "arm";
  const auto named = [&](const char* word) { return machine.name.find(word) != std::string::npos; };
  marks->four_corners = named("alpha") || named("mk2");
  if (named("silhouette-sd") || named("craft-robo")) marks->style = 0;
  return *marks;
}

}  // namespace popcut::cli
