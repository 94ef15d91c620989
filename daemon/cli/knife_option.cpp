// SPDX-License-Identifier: MIT
#include "daemon/cli/knife_option.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "core/formats/svg_scan.hpp"

namespace popcut::cli {
namespace {

Result<double> millimetres(const std::string& text, const char* option, double most) {
  SvgScan scan(text);
  double mm = 0.0;
  if (scan.number(mm) && scan.at_end() && mm >= 0.0 && mm <= most) return mm;
  return fail(ErrorKind::Usage, option,
              fmt::format("{} is not a length; 0 to {:g} (mm)", text.substr(0, 40), most));
}

Result<std::size_t> word(const std::string& text, const char* option,
                         const std::vector<std::string>& words) {
  const auto found = std::find(words.begin(), words.end(), text);
  if (found != words.end()) return static_cast<std::size_t>(found - words.begin());
  return fail(
      ErrorKind::Usage, option,
      fmt::format("{} is not known; one of {}", text.substr(0, 40), fmt::join(words, ", ")));
}

}  // namespace

void add_knife_options(CLI::App& command, KnifeOption& option) {
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

Result<void> read_knife_option(const KnifeOption& option, PlanOptions& options) {
  if (!option.folds.empty()) {
    const auto mode = word(option.folds, "--folds", {"perforate", "score", "light"});
    if (!mode) return tl::unexpected(mode.error());
    options.knife.folds = static_cast<FoldMode>(*mode);
  }
  const auto direction = word(option.direction, "--direction", {"any", "cw", "ccw"});
  if (!direction) return tl::unexpected(direction.error());
  options.knife.direction = static_cast<CutDirection>(*direction);
  if (!option.overcut.empty()) {
    const auto mm = millimetres(option.overcut, "--overcut", 10.0);
    if (!mm) return tl::unexpected(mm.error());
    options.knife.overcut_mm = *mm;
  }
  if (!option.snap.empty()) {
    const auto mm = millimetres(option.snap, "--snap", kMostSnap);
    if (!mm) return tl::unexpected(mm.error());
    options.clean.snap_mm = *mm;
  }
  return {};
}

std::vector<ToolKind> holders_for(const PlannedSheet& sheet) {
  std::vector<ToolKind> holders;
  for (const Stroke& stroke : sheet.path.strokes)
    if (holders.size() < stroke.tool) holders.resize(stroke.tool, ToolKind::Pen);
  for (std::size_t i = 0; i < holders.size(); ++i)
    if (sheet.knife.blade(static_cast<int>(i) + 1)) holders[i] = ToolKind::Blade;
  return holders;
}

}  // namespace popcut::cli
