// SPDX-License-Identifier: MIT
#include "daemon/cli/plan_job.hpp"

#include <utility>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "core/formats/svg_scan.hpp"
#include "daemon/cli/drawing_input.hpp"
#include "daemon/cli/user_tables.hpp"

namespace popcut::cli {
namespace {

Result<Machine> ideal(std::array<double, 2> size, const std::string& dialect) {
  if (dialect != "hpgl") return ideal_plotter(size[0], size[1]);
  auto machine = find_machine("hpgl-generic");
  if (!machine) return machine;
  machine->name = "ideal-hpgl";
  machine->firmware_blade_offset = true;  // nothing of a real knife is in its way
  machine->width_mm = size[0];
  machine->length_mm = size[1];
  return machine;
}

// --machine, or the ideal plotter of --mat WxH alone, or the Cameo 3 whose mats have names.
Result<Machine> choose_machine(const PlanJobOptions& options, const UserTables& tables) {
  const bool named = !options.machine.empty();
  const std::string fallback = options.dialect == "hpgl" ? "hpgl-generic" : "cameo3";
  auto machine = find_machine(named ? options.machine : fallback, tables.texts);
  if (!machine) {
    Error error = tables.with_file(machine.error());
    if (error.place.empty()) error = {ErrorKind::Usage, "--machine", error.detail};
    return tl::unexpected(error);
  }
  if (!named && !options.mat.empty()) {
    for (const Mat& mat : machine->mats)
      if (is_mat_name(mat, options.mat)) return machine;
    const auto size = parse_size_mm(options.mat);
    if (!size) return tl::unexpected(size.error());
    return ideal(*size, options.dialect);
  }
  if (!options.dialect.empty() && options.dialect != machine->language)
    return fail(ErrorKind::Usage, "--dialect",
                fmt::format("{} speaks {}, not {}; leave --dialect out, or take another --machine",
                            machine->name, machine->language, options.dialect));
  return machine;
}

Result<Material> choose_material(const std::string& name, const char* place,
                                 const UserTables& tables, const std::string& file) {
  auto material = find_material(name, tables.texts);
  if (material) return material;
  Error error = tables.with_file(material.error());
  const bool of_option = place[0] == '-';
  if (error.place.empty())
    error = {of_option ? ErrorKind::Usage : ErrorKind::OutOfRange,
             of_option ? place : fmt::format("{}: {}", file, place), error.detail};
  return tl::unexpected(error);
}

Result<SvgReadOptions> read_options(const PlanJobOptions& options, const UserTables& tables) {
  auto profile = find_stroke_profile(options.svg_profile, tables.texts);
  if (!profile) return tl::unexpected(tables.with_file(profile.error()));
  const double tolerance = options.curve_tolerance_mm, dpi = options.svg_dpi;
  if (!(tolerance >= 0.001 && tolerance <= 1.0))
    return fail(ErrorKind::Usage, "--curve-tolerance",
                fmt::format("{} mm; from 0.001 to 1 is needed", tolerance));
  if (!(dpi >= 1.0 && dpi <= 10'000.0))
    return fail(ErrorKind::Usage, "--svg-dpi", fmt::format("{}; from 1 to 10000 is needed", dpi));
  SvgReadOptions how;
  how.profile = std::move(*profile);
  how.tolerance_mm = tolerance;
  how.dpi = dpi;
  return how;
}

Result<PlanOptions> plan_options(const PlanJobOptions& options) {
  PlanOptions out;
  out.mat = options.mat;
  out.place.clip = options.clip;
  const auto how = order_options(options.order);
  if (!how) return tl::unexpected(how.error());
  out.order = *how;
  if (auto knife = read_knife_option(options.knife, out); !knife)
    return tl::unexpected(knife.error());
  if (auto split = read_split_option(options.split, out); !split)
    return tl::unexpected(split.error());
  if (options.at.empty()) {
    if (options.marks.wanted) out.place.at = PagePoint{16, 16};  // clear of the marks
    return out;
  }
  SvgScan scan(options.at);
  PagePoint at;
  if (!scan.number(at.x) || !scan.number(at.y) || !scan.at_end())
    return fail(ErrorKind::Usage, "--at",
                fmt::format("{} is not a place; X,Y in mm as in 20,30", options.at));
  out.place.at = at;
  return out;
}

// Marks tie a drawing to artwork on one page.
Error split_and_printed(const Plan& plan) {
  const Box box = bounds(plan.whole);
  const PlannedSheet& sheet = plan.sheets.front();
  return {ErrorKind::Infeasible, "",
          fmt::format("is {:.1f} x {:.1f} mm, too large for one sheet of {:.1f} x {:.1f} mm, and a "
                      "printed drawing is not split; scale it down, use a larger --mat, or leave "
                      "--marks out",
                      box.width(), box.height(), sheet.area_mm[0], sheet.area_mm[1])};
}

JobOptions job_options(const PlannedSheet& sheet, const Machine& machine) {
  JobOptions job;
  job.page_width_mm = sheet.area_mm[0];
  job.page_length_mm = sheet.area_mm[1];
  if (machine.variant == "cameo3" || machine.variant == "cameo4") job.mat_code = sheet.mat.code;
  job.autoblade = machine.autoblade;
  job.holders = holders_for(sheet);
  return job;
}

}  // namespace

std::string PlanJob::sheet_file(std::size_t sheet, const char* ending) {
  return fmt::format("sheet-{:02}.{}", sheet + 1, ending);
}

std::string PlanJob::program_file(std::size_t sheet) const {
  return sheet_file(sheet, programs[sheet].dialect == Dialect::Hpgl ? "hpgl" : "gpgl");
}

Result<PlanJob> make_plan_job(const PlanJobOptions& options) {
  const auto wanted = plan_options(options);
  if (!wanted) return tl::unexpected(wanted.error());
  if (!options.dialect.empty() && options.dialect != "gpgl" && options.dialect != "hpgl")
    return fail(ErrorKind::Usage, "--dialect",
                fmt::format("{} is not known; gpgl or hpgl", options.dialect));
  const auto tables = read_user_tables();
  if (!tables) return tl::unexpected(tables.error());
  const auto reading = read_options(options, *tables);
  if (!reading) return tl::unexpected(reading.error());
  const auto machine = choose_machine(options, *tables);
  if (!machine) return tl::unexpected(machine.error());
  const bool ideal_machine = machine->name.rfind("ideal", 0) == 0;
  auto input = options.drawing ? Result<DrawingInput>(DrawingInput{*options.drawing, std::nullopt})
                               : read_drawing(options.input, *reading);
  if (!input) return tl::unexpected(input.error());
  const auto material = choose_material(
      !options.material.empty() ? options.material : input->material.value_or("paper-220"),
      !options.material.empty() ? "--material" : "/material", *tables, options.input);
  if (!material) return tl::unexpected(material.error());

  PlanOptions how = *wanted;
  if (!input->seams_x.empty() && !how.split)
    return fail(ErrorKind::Infeasible, options.input,
                fmt::format("makes {} parts with seams between them, which --no-split forbids; "
                            "leave it out, or plan each part of popcut design",
                            input->seams_x.size() + 1));
  how.seams_x.insert(how.seams_x.end(), input->seams_x.begin(), input->seams_x.end());
  how.keep_lines = options.svg_profile == "origami-sim";
  if (ideal_machine) how.mat.clear();
  // An ideal plotter cuts lines as they are drawn.
  if (ideal_machine && !how.knife.overcut_mm) how.knife.overcut_mm = 0.0;
  auto planned = plan(std::move(input->drawing), *machine, *material, how);
  if (!planned) {
    const bool of_option = planned.error().place.rfind("--", 0) == 0;
    return tl::unexpected(of_option ? planned.error() : within(options.input, planned.error()));
  }
  PlanJob job{std::move(*planned), {}, {}};
  if (options.marks.wanted && job.plan.layout)
    return tl::unexpected(within(options.input, split_and_printed(job.plan)));
  for (PlannedSheet& sheet : job.plan.sheets) {
    JobOptions sent = job_options(sheet, *machine);
    const auto marks = read_mark_option(options.marks, *machine, sheet.area_mm);
    if (!marks) return tl::unexpected(marks.error());
    sent.marks = *marks;
    if (*marks) job.marks.push_back(**marks);
    sheet.registration = *marks;
    auto program = encode(sheet.sent_path(), *machine, *material, sent);
    if (!program) return tl::unexpected(within(options.input, program.error()));
    if (!program->dots.empty())
      job.plan.warnings.push_back(
          fmt::format("{} strokes are shorter than a step of {} mm and are not sent",
                      program->dots.size(), machine->unit_mm));
    job.programs.push_back(std::move(*program));
  }
  return job;
}

void add_plan_options(CLI::App& command, PlanJobOptions& options) {
  const auto text = [&](const char* name, std::string& value, const char* help, const char* shown) {
    command.add_option(name, value, help)->option_text(shown);
  };
  command.add_option("INPUT", options.input, "A SPEC (.json) or a drawing (.fold, .svg, .dxf)")
      ->required();
  text("--machine", options.machine, "The cutter; 'popcut machines' lists them", "NAME [cameo3]");
  text("--material", options.material, "What is cut; 'popcut materials' lists them",
       "NAME [paper-220]");
  text("--mat", options.mat,
       "A mat of the machine, or a size in mm, cm or in; without --machine the area of an ideal "
       "plotter",
       "NAME|WxH");
  text("--at", options.at, "Where the drawing's upper left corner goes, mm", "X,Y");
  add_order_options(command, options.order);
  text("--dialect", options.dialect, "gpgl or hpgl; without --machine it picks the machine",
       "WORD");
  text("--svg-profile", options.svg_profile,
       "What strokes of an SVG mean: popcut, origami-sim, lightburn, cricut, boxes-py, plain ...",
       "WORD [popcut]");
  add_knife_options(command, options.knife);
  add_split_options(command, options.split);
  add_mark_options(command, options.marks);
  command
      .add_option("--curve-tolerance", options.curve_tolerance_mm,
                  "How far a curve of a drawing may be from the lines that are cut, in mm")
      ->option_text("MM [0.02]");
  command
      .add_option("--svg-dpi", options.svg_dpi,
                  "Units (px) of an SVG to the inch; 72 for old Illustrator files")
      ->option_text("N [96]");
  command.add_flag("--clip", options.clip,
                   "Cut off what lies outside of the area instead of refusing");
}

}  // namespace popcut::cli
