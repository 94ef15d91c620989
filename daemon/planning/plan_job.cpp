// SPDX-License-Identifier: MIT
#include "daemon/planning/plan_job.hpp"

#include <utility>

#include <fmt/format.h>

#include "core/formats/svg/syntax/svg_scan.hpp"

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

// --machine, or the ideal plotter of --mat WxH alone, or the Cameo 3 whose mats have names.
Result<Machine> choose_machine(const PlanWords& words, const Tables& tables) {
  const bool named = !words.machine.empty();
  const std::string fallback = words.dialect == "hpgl" ? "hpgl-generic" : "cameo3";
  auto machine = find_machine(named ? words.machine : fallback, tables);
  if (!machine) {
    Error error = machine.error();
    if (error.place.empty()) error = {ErrorKind::Usage, "--machine", error.detail};
    return tl::unexpected(error);
  }
  if (!named && !words.mat.empty()) {
    for (const Mat& mat : machine->mats)
      if (is_mat_name(mat, words.mat)) return machine;
    const auto size = parse_size_mm(words.mat);
    if (!size) return tl::unexpected(size.error());
    return ideal(*size, words.dialect);
  }
  if (!words.dialect.empty() && words.dialect != machine->language)
    return fail(ErrorKind::Usage, "--dialect",
                fmt::format("{} speaks {}, not {}; leave --dialect out, or take another --machine",
                            machine->name, machine->language, words.dialect));
  return machine;
}

Result<Material> choose_material(const std::string& name, const char* place, const Tables& tables,
                                 const std::string& file) {
  auto material = find_material(name, tables);
  if (material) return material;
  Error error = material.error();
  const bool of_option = place[0] == '-';
  if (error.place.empty())
    error = {of_option ? ErrorKind::Usage : ErrorKind::OutOfRange,
             of_option ? place : fmt::format("{}: {}", file, place), error.detail};
  return tl::unexpected(error);
}

Result<SvgReadOptions> read_options(const PlanWords& words, const Tables& tables) {
  auto profile = find_stroke_profile(words.svg_profile, tables);
  if (!profile) return tl::unexpected(profile.error());
  const double tolerance = words.curve_tolerance_mm, dpi = words.svg_dpi;
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

Result<PlanOptions> plan_options(const PlanWords& words) {
  PlanOptions out;
  out.mat = words.mat;
  out.place.clip = words.clip;
  const auto how = order_options(words.order);
  if (!how) return tl::unexpected(how.error());
  out.order = *how;
  if (auto knife = read_knife_words(words.knife, out); !knife) return tl::unexpected(knife.error());
  if (auto split = read_split_words(words.split, out); !split) return tl::unexpected(split.error());
  if (words.at.empty()) {
    if (words.marks.wanted) out.place.at = PagePoint{16, 16};  // clear of the marks
    return out;
  }
  SvgScan scan(words.at);
  PagePoint at;
  if (!scan.number(at.x) || !scan.number(at.y) || !scan.at_end())
    return fail(ErrorKind::Usage, "--at",
                fmt::format("{} is not a place; X,Y in mm as in 20,30", words.at));
  out.place.at = at;
  return out;
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

/// The program of each sheet of a plan.
Result<void> encode_sheets(const PlanWords& words, PlanJob& job) {
  const Machine& machine = job.plan.machine;
  if (words.marks.wanted && job.plan.layout) return tl::unexpected(split_and_printed(job.plan));
  for (PlannedSheet& sheet : job.plan.sheets) {
    JobOptions sent = job_options(sheet, machine);
    const auto marks = read_mark_words(words.marks, machine, sheet.area_mm);
    if (!marks) return tl::unexpected(marks.error());
    sent.marks = *marks;
    if (*marks) job.marks.push_back(**marks);
    sheet.registration = *marks;
    auto program = encode(sheet.sent_path(), machine, job.plan.material, sent);
    if (!program) return tl::unexpected(program.error());
    if (!program->dots.empty())
      job.plan.warnings.push_back(
          fmt::format("{} strokes are shorter than a step of {} mm and are not sent",
                      program->dots.size(), machine.unit_mm));
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

Result<PlanJob> make_plan_job(const PlanWords& words, const std::vector<std::string>& tables,
                              const DrawingReader& read, const std::string& input_name) {
  const auto named = [&](Error error) {
    return input_name.empty() ? error : within(input_name, std::move(error));
  };
  const auto wanted = plan_options(words);
  if (!wanted) return tl::unexpected(wanted.error());
  if (!words.dialect.empty() && words.dialect != "gpgl" && words.dialect != "hpgl")
    return fail(ErrorKind::Usage, "--dialect",
                fmt::format("{} is not known; gpgl or hpgl", words.dialect));
  const auto reading = read_options(words, tables);
  if (!reading) return tl::unexpected(reading.error());
  const auto machine = choose_machine(words, tables);
  if (!machine) return tl::unexpected(machine.error());
  const bool ideal_machine = machine->name.rfind("ideal", 0) == 0;
  auto input = read(*reading);
  if (!input) return tl::unexpected(input.error());
  const auto material = choose_material(
      !words.material.empty() ? words.material : input->material.value_or("paper-220"),
      !words.material.empty() ? "--material" : "/material", tables, input_name);
  if (!material) return tl::unexpected(material.error());

  PlanOptions how = *wanted;
  if (!input->seams_x.empty() && !how.split)
    return tl::unexpected(named(
        {ErrorKind::Infeasible, "",
         fmt::format("makes {} parts with seams between them, which --no-split forbids; leave it "
                     "out, or plan each part of popcut design",
                     input->seams_x.size() + 1)}));
  how.seams_x.insert(how.seams_x.end(), input->seams_x.begin(), input->seams_x.end());
  how.keep_lines = words.svg_profile == "origami-sim";
  if (ideal_machine) how.mat.clear();
  // An ideal plotter cuts lines as they are drawn.
  if (ideal_machine && !how.knife.overcut_mm) how.knife.overcut_mm = 0.0;
  auto planned = plan(std::move(input->drawing), *machine, *material, how);
  if (!planned) {
    const bool of_option = planned.error().place.rfind("--", 0) == 0;
    return tl::unexpected(of_option ? planned.error() : named(planned.error()));
  }
  PlanJob job{std::move(*planned), {}, {}};
  if (auto encoded = encode_sheets(words, job); !encoded)
    return tl::unexpected(encoded.error().place.rfind("--", 0) == 0 ? encoded.error()
                                                                    : named(encoded.error()));
  return job;
}

}  // namespace popcut::planning
