// SPDX-License-Identifier: MIT
#include <algorithm>
#include <memory>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "core/figures/paper_figures.hpp"
#include "daemon/cli/command.hpp"
#include "daemon/cli/view/long_work.hpp"
#include "daemon/files/output_folder.hpp"

namespace popcut::cli {
namespace figures_command {
namespace {

Result<void> run_figures(const std::string& folder_name, const Globals& globals) {
  auto folder = OutputFolder::open(folder_name);
  if (!folder) return tl::unexpected(folder.error());
  std::optional<LongWork> work(std::in_place, !globals.quiet, "computing the figures");
  const auto figures = paper_figures();
  if (!figures) return tl::unexpected(figures.error());
  const std::string summary = figures_json(*figures);
  for (const FigureFile& file : figures->files) {
    if (auto done = folder->add(file.name, file.content); !done) return done;
  }
  if (auto done = folder->add("figures.json", summary); !done) return done;
  if (auto done = folder->commit("popcut figures " POPCUT_VERSION); !done) return done;
  work.reset();
  if (globals.json) fmt::print("{}", summary);
  const auto fails = std::count_if(figures->statements.begin(), figures->statements.end(),
                                   [](const CheckedStatement& s) { return !s.holds; });
  for (const CheckedStatement& s : figures->statements) {
    if (!globals.quiet || !s.holds)
      fmt::print(stderr, "  {:<7} {:<10} {} ({:.6g})\n", s.holds ? "holds" : "FAILS", s.figure,
                 s.claim, s.value);
  }
  if (!globals.quiet)
    fmt::print(stderr, "  wrote   {} drawings and tables, and figures.json, to {}\n",
               figures->files.size(), folder_name);
  if (fails == 0) return {};
  return fail(ErrorKind::CheckFailed, folder_name,
              fmt::format("{} of {} statements of the paper do not hold; figures.json lists them",
                          fails, figures->statements.size()));
}

constexpr const char* kHelp =
    "Draw the figures of the scientific paper from popcut's own numbers.\n\n"
    "  popcut figures -o figures\n\n"
    "Fig. 1C and 1D (K and H of the five-unit assembly), 2C top (azimuthal error as printed and "
    "at\n"
    "the outer corners) and bottom (loss against L/N), 3C (theta of a splayed unit), 3D (K of a\n"
    "splayed patch as it opens), S5 (minimisers; K and H over r, lambda, phi). Each is an SVG "
    "with\n"
    "its numbers as CSV. figures.json lists the statements of the paper and whether they hold. "
    "Exit\n"
    "code 6 if one does not.";

}  // namespace
}  // namespace figures_command

void register_figures(const Command& app, const Globals& globals, Run& run) {
  using namespace figures_command;
  auto folder = std::make_shared<std::string>();
  const Command command = app.add_command("figures", kHelp);
  command.add_option("-o,--output", *folder, "Folder for the files; created if it does not exist")
      .value_text("DIR")
      .required();
  when_chosen(command, run, [folder, &globals] { return run_figures(*folder, globals); });
}

}  // namespace popcut::cli
