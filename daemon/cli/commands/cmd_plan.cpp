// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <set>
#include <span>
#include <sstream>

#include <fmt/format.h>

#include "core/plan/plan.hpp"
#include "core/plan/sheet_pieces.hpp"
#include "core/print/pages.hpp"
#include "core/text/utf8.hpp"
#include "core/text/words.hpp"
#include "daemon/cli/command.hpp"
#include "daemon/cli/commands/program_sheet_file.hpp"
#include "daemon/cli/options/plan_arguments.hpp"
#include "daemon/files/output_folder.hpp"
#include "daemon/pictures/pdf.hpp"
#include "daemon/planning/make/program_sheets.hpp"

namespace popcut::cli {
namespace plan_command {
namespace {

struct Options {
  PlanArguments plan;
  std::string folder;
  std::string formats;
};

constexpr std::array<std::string_view, 8> kFormats{"svg", "program", "picture", "assembly",
                                                   "pdf", "dxf",     "laser",   "cricut"};
constexpr std::string_view kUsual = "svg,program,picture,assembly";

/// What --formats asks for, or what is usual.
struct Formats {
  std::set<std::string, std::less<>> given;

  [[nodiscard]] bool has(std::string_view name, const Machine& machine) const {
    if (!given.empty()) return given.contains(name);
    if (machine.language == "hand" && name == "pdf") return true;
    return kUsual.find(name) != std::string_view::npos;
  }
};

Result<Formats> parse_formats(std::string_view text) {
  Formats formats;
  while (!text.empty()) {
    const std::string_view part = text.substr(0, text.find(','));
    text.remove_prefix(std::min(text.size(), part.size() + 1));
    const std::string name(trimmed(part));
    if (std::find(kFormats.begin(), kFormats.end(), name) == kFormats.end())
      return fail(
          ErrorKind::Usage, "--formats",
          fmt::format("'{}' is not a format; give some of: {}", name, fmt::join(kFormats, " ")));
    formats.given.insert(name);
  }
  return formats;
}

Result<void> add_pdf(Plan& plan, OutputFolder& folder) {
  const auto pages = sheet_pages(plan);
  if (!pages) return tl::unexpected(pages.error());
  if (auto warning = font_warning(plan.name, "sheets.pdf"))
    plan.warnings.push_back(std::move(*warning));
  const auto pdf = pdf_of_pages(*pages, plan.name);
  if (!pdf) return tl::unexpected(pdf.error());
  return folder.add("sheets.pdf", *pdf);
}

// The programs whose sheets are written: by the machine, by the format and by the profile.
std::set<std::string_view> programs_of(const Machine& machine, const PlanArguments& arguments,
                                       const Formats& formats) {
  std::set<std::string_view> programs;
  if (machine.language == "cricut" || formats.given.contains("cricut")) programs.insert("cricut");
  if (formats.given.contains("laser")) programs.insert("lightburn");
  if (formats.given.contains("dxf")) programs.insert(planning::kDxfSheets);
  const auto profile = arguments.options.find("svg-profile");
  if (profile != arguments.options.end() && machine.language != "cricut")
    programs.insert(profile->second);
  return programs;
}

// One sheet: what will be cut, as other programs want it, its picture and its program.
Result<void> add_sheet(PlanJob& job, std::size_t i, const std::set<std::string_view>& programs,
                       const Formats& formats, OutputFolder& folder) {
  const Machine& machine = job.plan.machine;
  const PlannedSheet& sheet = job.plan.sheets[i];
  const std::string title = shown_text(fmt::format("{}: sheet {}", job.plan.name, i + 1));
  if (formats.has("svg", machine))
    if (auto done = folder.add(PlanJob::sheet_file(i, "svg"), sheet_svg(sheet, title)); !done)
      return done;
  for (const std::string_view program : programs)
    if (auto done = add_program_sheet(job.plan, i + 1, program, title, folder); !done) return done;
  if (!machine.driven()) return {};
  if (formats.has("picture", machine))
    if (auto done = folder.add(fmt::format("plan-{:02}.svg", i + 1), plan_svg(sheet, title)); !done)
      return done;
  if (formats.has("program", machine))
    if (auto done = folder.add(job.program_file(i), job.programs[i].bytes); !done) return done;
  if (job.marks.empty()) return {};
  return folder.add(PlanJob::sheet_file(i, "marks.svg"),
                    marks_svg(job.marks[i], sheet.area_mm, title));
}

double length_of(const Toolpath& path, Operation operation) {
  double mm = 0.0;
  for (const Stroke& stroke : path.strokes)
    if (stroke.operation == operation) mm += popcut::length(path.points_of(stroke));
  return mm;
}

// Which cards of a book are on a sheet.
void say_parts(const Plan& plan, std::size_t i) {
  if (const std::string names = part_names(parts_on_sheet(plan, i)); !names.empty())
    fmt::print(stderr, "           {}\n", names);
}

// How large what is cut on a sheet is.
std::string size_words(const Plan& plan, std::size_t i) {
  const Box box = bounds(planning::strokes_as_lines(plan.sheets[i], plan.folds, ""));
  return fmt::format("{:.1f} x {:.1f} mm ({:.3f} x {:.3f} in)", box.width(), box.height(),
                     box.width() / 25.4, box.height() / 25.4);
}

// Where popcut does not drive: what is on the sheet, and the file to take on.
void say_drawing(const Plan& plan, std::size_t i, const std::string& folder,
                 const Formats& formats) {
  const PlannedSheet& sheet = plan.sheets[i];
  fmt::print(stderr, "  sheet {}  {}, cut {:.0f} mm, ", i + 1, size_words(plan, i), sheet.cut_mm);
  if (plan.folds == FoldMode::Score)
    fmt::print(stderr, "score {:.0f} mm of folds", sheet.fold_line_mm);
  else
    fmt::print(stderr, "folds {:.0f} mm as {:.0f} mm of dashes", sheet.fold_line_mm, sheet.fold_mm);
  if (const double mm = length_of(sheet.path, Operation::Score); mm > 0.0)
    fmt::print(stderr, ", score {:.0f} mm of other lines", mm);
  fmt::print(stderr, "\n");
  say_parts(plan, i);
  const bool cricut = plan.machine.language == "cricut";
  if (cricut || formats.has("svg", plan.machine))
    fmt::print(
        stderr, "           {}/{}\n", folder,
        cricut ? fmt::format("sheet-{:02}-cricut.svg", i + 1) : PlanJob::sheet_file(i, "svg"));
}

// How well the pieces fill their sheets.
void say_use(const Layout& layout) {
  const SheetUse& use = layout.use;
  fmt::print(stderr, "  paper    {} pieces use {:.0f} % of {} sheet{}", layout.pieces.size(),
             100.0 * use.share(), layout.sheets.size(), layout.sheets.size() == 1 ? "" : "s");
  if (use.share() > use.rows_share())
    fmt::print(stderr, "; in rows they would use {:.0f} % of {}", 100.0 * use.rows_share(),
               use.rows_sheets);
  fmt::print(stderr, "; at least {} must be used\n",
             layout.least_sheets == 1 ? "1 sheet" : fmt::format("{} sheets", layout.least_sheets));
}

// The steps in Design Space.
void say_cricut(const Plan& plan) {
  const auto has = [&](auto wanted) {
    return std::any_of(plan.sheets.begin(), plan.sheets.end(), [&](const PlannedSheet& sheet) {
      return std::any_of(sheet.path.strokes.begin(), sheet.path.strokes.end(),
                         [&](const Stroke& stroke) { return wanted(stroke.operation); });
    });
  };
  std::string layers;
  const bool folds = plan.folds == FoldMode::Score;
  if (has([&](Operation o) { return o == Operation::Score || (folds && is_fold(o)); }))
    layers += "set the red layer to Score, ";
  if (has([](Operation o) { return o == Operation::Draw; }))
    layers += "set the green layer to Pen, ";
  fmt::print(
      stderr,
      "  next     in Design Space: Upload this file and add it to the canvas; its size there "
      "must be the one above\n           {}select all, Attach, Make\n",
      layers);
}

// An autoblade whose depth nobody sets may not cut through.
void say_blade(const PlanJob& job, const PlanArguments& arguments) {
  const Machine& machine = job.plan.machine;
  if (!machine.autoblade || machine.reports_tools() || arguments.options.contains("blade")) return;
  fmt::print(stderr, "  blade    set it to {} (an AutoBlade sets itself: add --blade autoblade)\n",
             job.plan.material.autoblade_depth);
}

void say(const PlanJob& job, const std::string& input, const std::string& folder,
         const Formats& formats) {
  const Plan& plan = job.plan;
  fmt::print(
      stderr, "{}\n",
      shown_text(fmt::format("{}: {} on {}", plan.name, plan.material.title, plan.machine.title)));
  if (plan.machine.name.starts_with("ideal"))
    fmt::print(
        stderr,
        "  note     --mat alone plans for an ideal plotter; name your cutter with --machine\n");
  for (std::size_t i = 0; i < plan.sheets.size(); ++i) {
    if (!plan.machine.driven()) {
      say_drawing(plan, i, folder, formats);
      continue;
    }
    const PlannedSheet& sheet = plan.sheets[i];
    const auto minutes = [](double seconds) { return seconds / 60; };
    fmt::print(
        stderr, "  sheet {}  {}, cut {:.0f} mm, folds {:.0f} mm {}, {} strokes\n", i + 1,
        size_words(plan, i), sheet.cut_mm, sheet.fold_line_mm,
        sheet.whole_folds ? "as whole lines" : fmt::format("as {:.0f} mm of dashes", sheet.fold_mm),
        sheet.path.strokes.size());
    fmt::print(stderr,
               "           travel {:.0f} mm (as drawn {:.0f}) in {:.0f} s, all in about {:.1f} min "
               "({:.1f} to "
               "{:.1f})\n",
               sheet.travel_mm, sheet.travel_input_mm, sheet.travel_s, minutes(sheet.seconds),
               minutes(sheet.seconds_range[0]), minutes(sheet.seconds_range[1]));
    say_parts(plan, i);
    if (formats.has("program", plan.machine))
      fmt::print(stderr, "           {}/{}\n", folder, job.program_file(i));
  }
  if (plan.layout && plan.layout->pieces.size() > 1) say_use(*plan.layout);
  if (plan.handwork) fmt::print(stderr, "  by hand  {}\n", hands::handwork_words(*plan.handwork));
  if (formats.has("pdf", plan.machine))
    fmt::print(stderr,
               "  next     print {}/sheets.pdf at actual size (100 %, not \"fit to page\"), and "
               "measure its bar\n",
               folder);
  if (formats.has("pdf", plan.machine)) say_guide(plan, input, 11);
  if (plan.machine.language == "cricut") say_cricut(plan);
  for (const Warning& warning : plan.warnings)
    fmt::print(stderr, "  warning  {}\n", shown_text(warning.message));
}

Result<void> run_plan(const Options& options, const Globals& globals) {
  if (options.folder.empty())
    return fail(ErrorKind::Usage, "command line",
                "-o DIR is missing; give the folder for the sheets");
  const auto formats = parse_formats(options.formats);
  if (!formats) return tl::unexpected(formats.error());
  PlanArguments arguments = options.plan;
  arguments.keep_lines = formats->given.contains("pdf");
  auto job = plan_input(arguments, !globals.quiet);
  if (!job) return tl::unexpected(job.error());
  const Machine& machine = job->plan.machine;
  if (!machine.driven())
    for (const char* name : {"program", "picture"})
      if (formats->given.contains(name))
        return fail(
            ErrorKind::Usage, "--formats",
            fmt::format("{} takes no programs from popcut; leave {} out", machine.title, name));
  auto folder = OutputFolder::open(options.folder);
  if (!folder) return tl::unexpected(folder.error());
  const auto programs = programs_of(machine, options.plan, *formats);
  for (std::size_t i = 0; i < job->plan.sheets.size(); ++i)
    if (auto done = add_sheet(*job, i, programs, *formats, *folder); !done) return done;
  if (formats->has("pdf", machine))
    if (auto done = add_pdf(job->plan, *folder); !done) return done;
  if (formats->has("assembly", machine))
    if (auto done = folder->add("assembly.svg", assembly_svg(job->plan)); !done) return done;
  const std::string json = plan_json(job->plan);
  if (auto done = folder->add("plan.json", json); !done) return done;
  if (auto done = folder->commit("popcut plan " POPCUT_VERSION); !done) return done;
  if (globals.json) fmt::print("{}", json);
  if (!globals.quiet) {
    say(*job, options.plan.input, options.folder, *formats);
    if (formats->has("program", machine)) say_blade(*job, options.plan);
  }
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
    "For another program, name its format: --formats dxf for Silhouette Studio, laser for "
    "LightBurn,\n"
    "cricut for Design Space. With --svg-profile cricut, lightburn or origami-sim you also get\n"
    "sheet-NN-PROFILE.svg.\n\n"
    "For a Cricut, name it (--machine cricut-maker): then there is no program, and\n"
    "sheet-NN-cricut.svg is what you upload in Design Space. To cut by hand:\n\n"
    "  popcut plan heart.svg -o sheets --machine none --mat A4\n\n"
    "writes sheets.pdf to print: pages at true scale with a legend and a bar to measure.";

}  // namespace
}  // namespace plan_command

void register_plan(const Command& app, const Globals& globals, Run& run) {
  using namespace plan_command;
  auto options = std::make_shared<Options>();
  const Command command = app.add_command("plan", kHelp);
  add_plan_arguments(command, options->plan);
  command
      .add_option("--formats", options->formats,
                  "Files to write beside plan.json, separated by commas: svg program picture "
                  "assembly pdf (sheets.pdf, to print at true scale; usual with --machine none) "
                  "dxf (sheet-NN.dxf, for Silhouette Studio) laser (sheet-NN-lightburn.svg) "
                  "cricut (sheet-NN-cricut.svg)")
      .value_text(fmt::format("LIST [{}]", kUsual));
  command
      .add_option("-o,--output", options->folder,
                  "Folder for the files; created if it does not exist")
      .value_text("DIR");
  when_chosen(command, run, [options, &globals] { return run_plan(*options, globals); });
}

}  // namespace popcut::cli
