// SPDX-License-Identifier: MIT
#include <cstdio>
#include <memory>
#include <sstream>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "core/formats/write/profile_svg.hpp"
#include "core/plan/plan.hpp"
#include "core/text/utf8.hpp"
#include "daemon/cli/command.hpp"
#include "daemon/cli/options/plan_arguments.hpp"
#include "daemon/files/output_folder.hpp"

namespace popcut::cli {
namespace plan_command {
namespace {

LineWork strokes_as_lines(const Toolpath& path, const std::string& title) {
  LineWork work;
  work.name = title;
  work.dashed = true;
  work.points.reserve(path.points.size());
  for (const Stroke& stroke : path.strokes) work.append(stroke.operation, path.points_of(stroke));
  return work;
}

// The mats of that maker keep a quarter of an inch free all round.
CricutMat cricut_mat(const PlannedSheet& sheet) {
  constexpr double kMmPerInch = 25.4;
  CricutMat mat;
  const double inches = sheet.area_mm[1] / kMmPerInch;
  if (inches > mat.height_in + 0.5 + 1e-6) mat.height_in = 23.5;
  return mat;
}

// Adds sheet `number` (from 1) as another program wants it, `sheet-NN-PROFILE.svg`, for the
// profiles cricut, lightburn and origami-sim; nothing for the others. A sheet that is too large
// for that program's mat is noted in `warnings`.
Result<void> add_profile_sheet(const PlannedSheet& sheet, std::size_t number,
                               const std::string& profile, const std::string& title,
                               OutputFolder& folder, std::vector<Warning>& warnings) {
  const std::string name = fmt::format("sheet-{:02}-{}.svg", number, profile);
  std::ostringstream out;
  if (profile == "cricut") {
    const auto written =
        write_cricut_svg(strokes_as_lines(sheet.path, title), cricut_mat(sheet), out);
    if (!written) {
      warnings.push_back(
          {.code = "not_written",
           .message = fmt::format("{} is not written: {}", name, written.error().detail),
           .place = {.sheet = static_cast<int>(number)}});
      return {};
    }
  } else if (profile == "lightburn") {
    write_lightburn_svg(strokes_as_lines(sheet.path, title), sheet.area_mm, out);
  } else if (profile == "origami-sim" && sheet.lines) {
    write_origami_sim_svg(*sheet.lines, out);
  } else {
    return {};
  }
  return folder.add(name, out.str());
}

struct Options {
  PlanArguments plan;
  std::string folder;
};

void say(const PlanJob& job, const std::string& folder) {
  const Plan& plan = job.plan;
  fmt::print(
      stderr, "{}\n",
      shown_text(fmt::format("{}: {} on {}", plan.name, plan.material.title, plan.machine.title)));
  for (std::size_t i = 0; i < plan.sheets.size(); ++i) {
    const PlannedSheet& sheet = plan.sheets[i];
    const auto minutes = [](double seconds) { return seconds / 60; };
    fmt::print(stderr,
               "  sheet {}  cut {:.0f} mm, folds {:.0f} mm as {:.0f} mm of dashes, {} strokes\n",
               i + 1, sheet.cut_mm, sheet.fold_line_mm, sheet.fold_mm, sheet.path.strokes.size());
    fmt::print(
        stderr,
        "           travel {:.0f} mm (as drawn {:.0f}), about {:.1f} min ({:.1f} to {:.1f})\n",
        sheet.travel_mm, sheet.travel_input_mm, minutes(sheet.seconds),
        minutes(sheet.seconds_range[0]), minutes(sheet.seconds_range[1]));
    fmt::print(stderr, "           {}/{}\n", folder, job.program_file(i));
  }
  for (const Warning& warning : plan.warnings)
    fmt::print(stderr, "  warning  {}\n", shown_text(warning.message));
}

Result<void> run_plan(const Options& options, const Globals& globals) {
  if (options.folder.empty())
    return fail(ErrorKind::Usage, "command line",
                "-o DIR is missing; give the folder for the sheets");
  auto job = plan_input(options.plan, !globals.quiet);
  if (!job) return tl::unexpected(job.error());
  auto folder = OutputFolder::open(options.folder);
  if (!folder) return tl::unexpected(folder.error());
  const auto given = options.plan.options.find("svg-profile");
  const std::string profile = given != options.plan.options.end() ? given->second : "";
  for (std::size_t i = 0; i < job->plan.sheets.size(); ++i) {
    const std::string title = shown_text(fmt::format("{}: sheet {}", job->plan.name, i + 1));
    if (auto done =
            folder->add(PlanJob::sheet_file(i, "svg"), sheet_svg(job->plan.sheets[i], title));
        !done)
      return done;
    const std::string picture = fmt::format("plan-{:02}.svg", i + 1);
    if (auto done = folder->add(picture, plan_svg(job->plan.sheets[i], title)); !done) return done;
    if (auto done = add_profile_sheet(job->plan.sheets[i], i + 1, profile, title, *folder,
                                      job->plan.warnings);
        !done)
      return done;
    if (auto done = folder->add(job->program_file(i), job->programs[i].bytes); !done) return done;
    if (job->marks.empty()) continue;
    const std::string marks = marks_svg(job->marks[i], job->plan.sheets[i].area_mm, title);
    if (auto done = folder->add(PlanJob::sheet_file(i, "marks.svg"), marks); !done) return done;
  }
  if (auto done = folder->add("assembly.svg", assembly_svg(job->plan)); !done) return done;
  const std::string json = plan_json(job->plan);
  if (auto done = folder->add("plan.json", json); !done) return done;
  if (auto done = folder->commit("popcut plan " POPCUT_VERSION); !done) return done;
  if (globals.json) fmt::print("{}", json);
  if (!globals.quiet) say(*job, options.folder);
  return {};
}

constexpr const char* kHelp =
    "Plan the sheets of a design or drawing, and write the programs that cut them.\n\n"
    "  popcut plan sphere.json -o sheets --machine cameo3 --material paper-220\n\n"
    "Folds become dashes. Each line is cut once: folds first, the outline last. A drawing that is\n"
    "too large for one sheet is split into pieces with tabs to glue. popcut writes into DIR:\n\n"
    "  sheet-NN.svg            what will be cut, in mm\n"
    "  sheet-NN.gpgl or .hpgl  the program for the cutter\n"
    "  plan-NN.svg             a picture of the order of the cuts, as colours\n"
    "  assembly.svg            where each piece goes\n"
    "  plan.json               lengths, time and warnings\n\n"
    "With --svg-profile cricut, lightburn or origami-sim you also get sheet-NN-PROFILE.svg for "
    "that\n"
    "program.";

}  // namespace
}  // namespace plan_command

void register_plan(CLI::App& app, const Globals& globals, Run& run) {
  using namespace plan_command;
  auto options = std::make_shared<Options>();
  CLI::App* const command = app.add_subcommand("plan", kHelp);
  add_plan_arguments(*command, options->plan);
  command
      ->add_option("-o,--output", options->folder,
                   "Folder for the files; created if it does not exist")
      ->option_text("DIR");
  when_chosen(command, run, [options, &globals] { return run_plan(*options, globals); });
}

}  // namespace popcut::cli
