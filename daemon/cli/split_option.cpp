// SPDX-License-Identifier: MIT
#include "daemon/cli/split_option.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

namespace popcut::cli {
namespace {

Result<void> check_seams(const std::vector<double>& seams, const char* option) {
  for (const double mm : seams)
    if (!(std::abs(mm) <= kMaxCoordinate))
      return fail(ErrorKind::Usage, option,
                  fmt::format("{:g} is no place; mm from the drawing's left or upper edge", mm));
  return {};
}

}  // namespace

void add_split_options(CLI::App& command, SplitOption& option) {
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

Result<void> read_split_option(const SplitOption& option, PlanOptions& options) {
  constexpr std::array kWords{"auto", "pen", "cut", "none"};
  const auto word = std::find(kWords.begin(), kWords.end(), option.labels);
  if (word == kWords.end())
    return fail(ErrorKind::Usage, "--labels",
                fmt::format("{} is not known; one of {}", option.labels.substr(0, 40),
                            fmt::join(kWords, ", ")));
  if (auto lawful = check_seams(option.seams_x, "--seam-x"); !lawful) return lawful;
  if (auto lawful = check_seams(option.seams_y, "--seam-y"); !lawful) return lawful;
  if (option.never && !(option.seams_x.empty() && option.seams_y.empty()))
    return fail(ErrorKind::Usage, "--no-split",
                "contradicts --seam-x and --seam-y; give one or the other");
  options.labels = static_cast<LabelTool>(word - kWords.begin());
  options.seams_x = option.seams_x;
  options.seams_y = option.seams_y;
  options.split = !option.never;
  return {};
}

}  // namespace popcut::cli
