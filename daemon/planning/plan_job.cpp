// SPDX-License-Identifier: MIT
#include "daemon/planning/plan_job.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "core/machines/motion.hpp"
#include "core/plan/drawing_transform.hpp"
#include "core/plan/marks.hpp"
#include "core/plan/pens.hpp"

namespace popcut::planning {
namespace {

using Tables = std::vector<std::string>;

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

// The machine, or the ideal plotter of a mat's size alone, or the Cameo 3 whose mats have names.
Result<Machine> choose_machine(const PlanOptions& options, const Tables& tables) {
  const bool named = !options.machine.empty();
  const std::string fallback = options.dialect == "hpgl" ? "hpgl-generic" : "cameo3";
  auto machine = find_machine(named ? options.machine : fallback, tables);
  if (!machine) {
    Error error = machine.error();
    if (error.place.empty()) error = {ErrorKind::Usage, "/machine", error.detail};
    return tl::unexpected(error);
  }
  if (!named && !options.mat.empty()) {
    for (const Mat& mat : machine->mats)
      if (is_mat_name(mat, options.mat)) return machine;
    const auto size = parse_size_mm(options.mat);
    if (!size) return tl::unexpected(size.error());
    return ideal(*size, options.dialect);
  }
  if (!options.dialect.empty() && !machine->driven())
    return fail(ErrorKind::Usage, "/options/dialect",
                fmt::format("is the language of a program, and {} takes none; leave `dialect` out, "
                            "or choose another `machine`",
                            machine->title));
  if (!options.dialect.empty() && options.dialect != machine->language)
    return fail(
        ErrorKind::Usage, "/options/dialect",
        fmt::format("{} speaks {}, not {}; leave `dialect` out, or choose another `machine`",
                    machine->name, machine->language, options.dialect));
  return machine;
}

/// The material of the options, or of the input.
Result<Material> choose_material(const PlanOptions& options, const DrawingInput& input,
                                 const Tables& tables, const std::string& file) {
  const bool named = !options.material.empty();
  auto material =
      find_material(named ? options.material : input.material.value_or("paper-220"), tables);
  if (material || !material.error().place.empty()) return material;
  return fail(named ? ErrorKind::Usage : ErrorKind::OutOfRange,
              named ? "/material" : file + ": /material", material.error().detail);
}

}  // namespace

Result<SvgReadOptions> read_options(const PlanOptions& options,
                                    const std::vector<std::string>& tables) {
  auto profile = find_stroke_profile(options.svg_profile, tables);
  if (!profile) return tl::unexpected(profile.error());
  SvgReadOptions how;
  how.profile = std::move(*profile);
  auto layers = parse_layer_uses(options.layers);
  if (!layers) return tl::unexpected(layers.error());
  for (const auto& [name, use] : *layers) how.profile.labels[name] = use;
  auto colours = parse_colour_uses(options.colors);
  if (!colours) return tl::unexpected(colours.error());
  how.profile.colours = std::move(*colours);
  how.tolerance_mm = reading_tolerance_mm(options);
  how.enlarged = options.scale;
  how.dpi = options.svg_dpi;
  how.pdf_page = options.pdf_page;
  how.weld = options.weld;
  how.unit_mm = unit_mm(options.units);
  how.pens = named_pens(options.pens);
  return how;
}

namespace {

/// Reads the input. What `width` makes of a drawing is known only when it is read: then it is read
/// once more, so that nothing is flattened or joined for a size that it does not have. A design has
/// its size.
///
/// @param how  gets what it was read with
Result<DrawingInput> read_at_its_size(const PlanOptions& options, SvgReadOptions& how,
                                      const DrawingReader& read) {
  auto input = read(how);
  if (!input || !options.width_mm || input->material) return input;
  const Placement map = drawing_transform(input->drawing, options);
  const double larger = std::hypot(map.xx, map.yx);
  if (!(larger > 0) || !std::isfinite(larger) || larger == 1) return input;
  how.enlarged = larger;
  how.tolerance_mm = options.curve_tolerance_mm / std::max(larger, 1.0);
  return read(how);
}

/// Says that a drawing is smaller than what anybody cuts from paper: its numbers may be inches or
/// centimetres. A design has its size, and so has what a person scales or gives a unit.
std::optional<Warning> very_small(const PlanOptions& options, const DrawingInput& input) {
  constexpr double kSmall_mm = 15.0;
  if (input.material || input.at || options.width_mm || options.scale != 1.0 ||
      unit_mm(options.units))
    return std::nullopt;
  const Box box = bounds(input.drawing);
  if (box.empty() || std::max(box.width(), box.height()) >= kSmall_mm) return std::nullopt;
  return Warning{.code = "very_small",
                 .message = fmt::format(
                     "the drawing is only {:.3g} x {:.3g} mm; if it is meant in inches, use "
                     "`scale` 25.4, in centimetres 10",
                     box.width(), box.height()),
                 .spoils = true};
}

/// The tool in each holder of a sheet: the firmware needs the offset of a blade.
std::vector<ToolKind> holders_for(const PlannedSheet& sheet) {
  std::vector<ToolKind> holders;
  for (const Stroke& stroke : sheet.path.strokes)
    if (holders.size() < stroke.tool) holders.resize(stroke.tool, ToolKind::Pen);
  for (std::size_t i = 0; i < holders.size(); ++i)
    if (sheet.knife.blade(static_cast<int>(i) + 1)) holders[i] = ToolKind::Blade;
  return holders;
}

/// The registration marks of a sheet; none where they were not asked for.
Result<std::optional<MarkLayout>> marks_of(const PlanOptions& options, const Machine& machine,
                                           const PlannedSheet& sheet) {
  if (!options.marks) return std::nullopt;
  auto marks = marks_for(sheet.area_mm);
  if (!marks) return tl::unexpected(marks.error());
  marks->arm_first = options.mark_form == MarkForm::Arm;
  const auto named = [&](const char* word) { return machine.name.find(word) != std::string::npos; };
  marks->four_corners = named("alpha") || named("mk2");
  if (named("silhouette-sd") || named("craft-robo")) marks->style = 0;
  return *marks;
}

JobOptions job_options(const PlannedSheet& sheet, const Machine& machine,
                       const PlanOptions& options) {
  JobOptions job;
  job.page_width_mm = sheet.area_mm[0];
  job.page_length_mm = sheet.area_mm[1];
  if (machine.variant == "cameo3" || machine.variant == "cameo4") job.mat_code = sheet.mat.code;
  job.autoblade = sets_autoblade(machine, options.blade);
  job.ask_blade = options.blade == BladeKind::Auto;
  job.track_enhancing = options.track_enhancing;
  job.feed_out_mm = sheet.feed_out_mm;
  job.holders = holders_for(sheet);
  return job;
}

// Artwork that was drawn for the whole drawing fits none of its sheets.
Warning split_and_printed(const Plan& plan) {
  const Box box = bounds(plan.whole);
  const auto room = room_within_marks_mm(plan.sheets.front().area_mm);
  const std::size_t sheets = plan.sheets.size();
  return {
      .code = "marks_split",
      .message = fmt::format(
          "the drawing of {:.1f} x {:.1f} mm does not fit between the marks of one sheet ({:.1f} "
          "x {:.1f} mm), so it is cut as {} pieces on {}{}; artwork for the whole drawing fits "
          "none of the sheets, and 'popcut print' makes that of each sheet",
          box.width(), box.height(), room[0], room[1], plan.layout->pieces.size(),
          sheets == 1 ? "one sheet" : fmt::format("{} sheets, each with its own marks", sheets),
          plan.layout->tabs.empty() ? "" : ", to glue together")};
}

/// What a person says of the search for marks takes the place of the machine's row.
Result<void> set_search(const PlanOptions& options, MarkSearch& search) {
  const std::vector<double>& start = options.mark_start;
  if (!options.marks && !(start.empty() && options.mark_again.empty()))
    return fail(ErrorKind::Usage, start.empty() ? "/options/mark-again" : "/options/mark-start",
                "is about registration marks; add `marks`, or leave it out");
  if (!start.empty() && start.size() != 2)
    return fail(ErrorKind::Usage, "/options/mark-start",
                fmt::format("has {} numbers; give two: how far left of the marks and how far above "
                            "them, in mm, such as 10,7",
                            start.size()));
  if (!start.empty()) search.before_left_mm = start[0], search.before_top_mm = start[1];
  if (!options.mark_again.empty()) search.again_mm = options.mark_again;
  return {};
}

/// The program of each sheet of a plan.
Result<void> encode_sheets(const PlanOptions& options, PlanJob& job) {
  if (auto set = set_search(options, job.plan.machine.marks); !set) return set;
  const Machine& machine = job.plan.machine;
  if (options.marks && job.plan.layout) job.plan.warnings.push_back(split_and_printed(job.plan));
  for (PlannedSheet& sheet : job.plan.sheets) {
    JobOptions sent = job_options(sheet, machine, options);
    const auto marks = marks_of(options, machine, sheet);
    if (!marks) return tl::unexpected(marks.error());
    sent.marks = *marks;
    if (*marks) job.marks.push_back(**marks);
    sheet.registration = *marks;
    if (*marks) {
      const double search_s =
          search_seconds((*marks)->width_mm, (*marks)->height_mm, machine.marks);
      sheet.seconds += search_s;
      sheet.seconds_range[0] += search_s * (1 - machine.motion.spread);
      sheet.seconds_range[1] += search_s * (1 + machine.motion.spread);
    }
    auto program = encode(sheet.sent_path(), machine, job.plan.material, sent);
    if (!program) return tl::unexpected(program.error());
    if (!program->dots.empty())
      job.plan.warnings.push_back(
          {.code = "stroke_short",
           .message = fmt::format("{} strokes are shorter than a step of {} mm and are not cut",
                                  program->dots.size(), machine.unit_mm),
           .place = {.sheet = static_cast<int>(&sheet - job.plan.sheets.data()) + 1}});
    job.programs.push_back(std::move(*program));
  }
  return {};
}

}  // namespace

std::string PlanJob::sheet_file(std::size_t sheet, const char* ending) {
  return fmt::format("sheet-{:02}.{}", sheet + 1, ending);
}

std::string PlanJob::program_file(std::size_t sheet) const {
  return sheet_file(sheet, programs[sheet].dialect == Dialect::Hpgl ? "hpgl" : "gpgl");
}

Result<PlanJob> make_plan_job(const PlanOptions& options, const std::vector<std::string>& tables,
                              const DrawingReader& read, const std::string& input_name) {
  // Errors of an option place themselves; the others are in the input.
  const auto named = [&](Error error) {
    const bool of_option = error.place.starts_with("/options/");
    return tl::unexpected(of_option || input_name.empty() ? std::move(error)
                                                          : within(input_name, std::move(error)));
  };
  auto reading = read_options(options, tables);
  if (!reading) return tl::unexpected(reading.error());
  const auto machine = choose_machine(options, tables);
  if (!machine) return tl::unexpected(machine.error());
  const auto hands = hands::hands_of(tables);
  if (!hands) return tl::unexpected(hands.error());
  if (!machine->driven() && options.marks)
    return fail(ErrorKind::Usage, "/options/marks",
                fmt::format("needs a cutter that looks for them, and {} takes no programs from "
                            "popcut; leave `marks` out",
                            machine->title));
  if (!machine->driven() && options.knife.overcut_mm.value_or(0.0) > 0.0)
    return fail(
        ErrorKind::Usage, "/options/overcut",
        fmt::format("goes into a program, and {} takes none; leave `overcut` out", machine->title));
  const bool ideal_machine = machine->name.rfind("ideal", 0) == 0;
  tell(options.progress, "reading the input");
  auto input = read_at_its_size(options, *reading, read);
  if (!input) return tl::unexpected(input.error());
  // A person gave the size that the file does not.
  if (options.width_mm)
    std::erase_if(input->drawing.warnings,
                  [](const Warning& warning) { return warning.code == "no_unit"; });
  if (auto said = very_small(options, *input)) input->drawing.warnings.push_back(std::move(*said));
  auto material = choose_material(options, *input, tables, input_name);
  if (!material) return tl::unexpected(material.error());
  material = with_pens(on_machine(std::move(*material), *machine), input->pens);
  Result<void> pens = material ? Result<void>{} : tl::unexpected(material.error());
  if (pens && !material->pens.empty()) {
    give_pens(input->drawing, material->pens);
    pens = check_pens(input->drawing, material->pens);
  }
  if (!pens) {
    pens.error().kind = ErrorKind::Malformed;
    pens.error().place = "/pen";
    return named(pens.error());
  }
  material = with_pens(std::move(*material), options.pens);
  if (!material) return tl::unexpected(material.error());
  give_pens(input->drawing, material->pens);
  if (pens = check_pens(input->drawing, material->pens); !pens) return tl::unexpected(pens.error());

  if (!input->seams_x.empty() && options.no_split)
    return named(
        {ErrorKind::Infeasible, "",
         fmt::format("makes {} parts with seams between them, and `no-split` forbids that; "
                     "leave it out, or plan each part of popcut design",
                     input->seams_x.size() + 1)});
  PlanOptions how = options;
  how.seams_x.insert(how.seams_x.end(), input->seams_x.begin(), input->seams_x.end());
  how.letters_taken = input->tabs;
  how.tells_doubles = !input->material;  // a design is made for the knife
  how.keep_lines = options.keep_lines || options.svg_profile == "origami-sim";
  if (!how.place.at) {
    how.place.at = options.marks ? PagePoint{kBesideMarksMm, kBesideMarksMm} : input->at;
    how.place.at_is_usual = options.marks;
  }
  if (ideal_machine) how.mat.clear();
  // An ideal plotter cuts lines as they are drawn.
  if (ideal_machine && !how.knife.overcut_mm) how.knife.overcut_mm = 0.0;
  auto planned = plan(std::move(input->drawing), *machine, *material, how);
  if (!planned) return named(planned.error());
  planned->unit_mm = reading->unit_mm;
  planned->curve_tolerance_mm = reading->tolerance_mm;
  planned->parts = std::move(input->parts);
  planned->glue_marks = std::move(input->glue_marks);
  if (!planned->fold_lengths_mm.empty()) {
    const std::size_t copies = std::max<std::size_t>(1, planned->copies.size());
    const std::size_t of_layout = planned->layout ? planned->layout->tabs.size() : 0;
    planned->handwork = hands::handwork(planned->fold_lengths_mm, input->waste * copies,
                                        input->tabs * copies + of_layout, *hands);
  }
  PlanJob job{std::move(*planned), {}, {}};
  if (!machine->driven()) return job;
  tell(options.progress, "writing the programs");
  if (auto encoded = encode_sheets(options, job); !encoded) return named(encoded.error());
  return job;
}

Error in_request(Error error) {
  if (error.kind == ErrorKind::Usage) error.kind = ErrorKind::OutOfRange;
  return error;
}

}  // namespace popcut::planning
