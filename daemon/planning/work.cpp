// SPDX-License-Identifier: MIT
#include "daemon/planning/work.hpp"
#include "daemon/pictures/pdf_page.hpp"

#include <algorithm>
#include <charconv>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/design/book_fit.hpp"
#include "core/design/shape_fit.hpp"
#include "core/plan/marks.hpp"
#include "core/plan/plan.hpp"
#include "core/plan/sheet_strokes.hpp"
#include "core/text/json_text.hpp"
#include "daemon/digest/digest.hpp"
#include "daemon/planning/plan_input.hpp"
#include "daemon/planning/plan_job.hpp"
#include "daemon/planning/program_file.hpp"
#include "daemon/planning/task_inputs.hpp"
#include "daemon/planning/views/preview.hpp"

namespace popcut::planning {
namespace {

using daemon::PlanningOutcome;
using Kind = daemon::PlanningTask::Kind;

// 1. Plans.

daemon::SheetPlan figures_of(const PlanJob& job, std::size_t index) {
  const PlannedSheet& sheet = job.plan.sheets[index];
  daemon::SheetPlan figures;
  figures.number = static_cast<int>(index) + 1;
  figures.paths = static_cast<int>(job.programs[index].strokes.size());
  figures.cut_mm = sheet.cut_mm;
  figures.fold_mm = sheet.fold_mm;
  figures.travel_mm = sheet.travel_mm;
  figures.seconds = sheet.seconds;
  figures.seconds_range = sheet.seconds_range;
  figures.area_mm = sheet.area_mm;
  figures.program_sha256 = daemon::sha256_hex(job.programs[index].bytes);
  figures.mat = sheet.mat.name;
  figures.side = sheet.registration ? "printed" : "drawn";
  return figures;
}

// `sides`: of each sheet, which one is up.
Result<void> add_plan_files(const PlanJob& job, const std::vector<std::string>& sides,
                            const FileSink& add) {
  for (std::size_t i = 0; i < job.plan.sheets.size(); ++i) {
    const std::string title = fmt::format("{}: sheet {}", job.plan.name, i + 1);
    const PlannedSheet& sheet = job.plan.sheets[i];
    auto done =
        add(job.program_file(i), job.programs[i].bytes)
            .and_then([&] {
              return add(PlanJob::sheet_file(i, "program.json"), program_index(job.programs[i]));
            })
            .and_then([&] { return add(PlanJob::sheet_file(i, "svg"), sheet_svg(sheet, title)); })
            .and_then([&] {
              return add(PlanJob::sheet_file(i, "strokes.json"),
                         sheet_strokes_json(job.plan, i, sides[i]));
            });
    if (done && !job.marks.empty())
      done =
          add(PlanJob::sheet_file(i, "marks.svg"), marks_svg(job.marks[i], sheet.area_mm, title));
    if (!done) return done;
  }
  return add("assembly.svg", assembly_svg(job.plan)).and_then([&] {
    return add("plan.json", plan_json(job.plan));
  });
}

Result<PlanningOutcome> outcome_of(const PlanJob& job, PlanningOutcome outcome,
                                   const FileSink& add) {
  for (std::size_t i = 0; i < job.plan.sheets.size(); ++i)
    outcome.sheets.push_back(figures_of(job, i));
  const bool pops_up = outcome.design_kind == name_of(InputKind::Spec);
  for (daemon::SheetPlan& sheet : outcome.sheets)
    if (pops_up && sheet.side == "drawn") sheet.side = "pop-up";
  outcome.warnings.insert(outcome.warnings.end(), job.plan.warnings.begin(),
                          job.plan.warnings.end());
  if (const auto& work = job.plan.handwork)
    outcome.handwork = {.folds = static_cast<std::int64_t>(work->folds),
                        .shortest_fold_mm = work->shortest_mm,
                        .waste = static_cast<std::int64_t>(work->waste),
                        .tabs = static_cast<std::int64_t>(work->tabs),
                        .fold_s = work->time_s,
                        .label = work->label};
  outcome.sha256 = sha256_of(job.programs);
  std::vector<std::string> sides;
  for (const daemon::SheetPlan& sheet : outcome.sheets) sides.push_back(sheet.side);
  if (auto done = add_plan_files(job, sides, add); !done) return tl::unexpected(done.error());
  return outcome;
}

}  // namespace

Result<PlanJob> planned(WorkerTask& task, PlanningOutcome& outcome, SpecSources sources,
                        const Progress& progress, bool by_hand) {
  auto options = read_plan_options(task.options);
  if (!options) return tl::unexpected(in_request(options.error()));
  const auto tables = tables_of(task);
  if (!tables) return tl::unexpected(tables.error());
  if (const auto machine = find_driven_machine(tables->machine, tables->texts);
      !by_hand && !machine && !machine.error().place.starts_with("table"))
    return tl::unexpected(within("/machine", machine.error()));
  if (!by_hand || !task.machine_json.empty()) options->machine = tables->machine;
  options->material = tables->material;
  options->progress = progress;
  sources.assets = [&](const DesignSpec& spec) { return assets_for(spec, task.assets); };
  sources.tables = tables->texts;
  sources.material = options->material;
  sources.progress = progress;
  const auto read = [&](const SvgReadOptions& how) -> Result<DrawingInput> {
    if (task.kind == Kind::TestCut) return test_shape_input();
    const auto kind =
        task.design_kind.empty() ? kind_of_content(task.design) : input_kind_from(task.design_kind);
    if (!kind) return tl::unexpected(kind.error());
    outcome.design_kind = std::string(name_of(*kind));
    auto input = drawing_from_text(task.design, *kind, how, 1, sources);
    if (input && input->drawing.name.empty()) input->drawing.name = "design";
    return input;
  };
  auto job = make_plan_job(*options, tables->texts, read, "");
  if (!job) return tl::unexpected(in_request(job.error()));
  return job;
}

namespace {

Result<PlanningOutcome> make_plan(WorkerTask& task, const FileSink& add, const Progress& progress) {
  PlanningOutcome outcome;
  SpecSources sources;
  sources.designed = [&](const DesignSpec& spec, PatchAssembly& made) -> Result<void> {
    if (const auto ids = asset_ids(spec)) outcome.assets = *ids;
    for (Design& part : made.parts) part.report.surface_fit = surface_fit(part);
    if (made.book) made.book->fit = book_fit(made);
    return add_design_files(made, add, outcome.warnings);
  };
  const auto job = planned(task, outcome, std::move(sources), progress);
  if (!job) return tl::unexpected(job.error());
  return outcome_of(*job, std::move(outcome), add);
}

// 2. Checks.

/// A spec's preview is the pattern it gives. That there is none is no fault of the spec's form.
Result<std::string> spec_preview(const DesignSpec& spec, WorkerTask& task,
                                 std::vector<Warning>& warnings) {
  if (const long units = units_of(spec); units > most_quick_units(spec))
    return no_preview_svg(
        fmt::format("this design has {} units; popcut draws it when you plan it", units));
  for (const auto& [place, name] : files_of(spec))
    if (!task.assets.contains(name))
      return no_preview_svg(fmt::format("{}: the asset {} is not uploaded yet", place, name));
  SpecSources sources{[&](const DesignSpec& own) { return assets_for(own, task.assets); }};
  if (const auto tables = tables_of(task)) sources.tables = tables->texts;
  const auto drawn = drawing_from_text(task.design, InputKind::Spec, {}, 1, sources);
  if (drawn) return preview_svg(drawn->drawing);
  warnings.push_back({.code = "no_preview", .message = message(drawn.error())});
  return no_preview_svg(message(drawn.error()));
}

Result<PlanningOutcome> check(WorkerTask& task, const FileSink& add) {
  const auto kind =
      task.design_kind.empty() ? kind_of_content(task.design) : input_kind_from(task.design_kind);
  if (!kind) return tl::unexpected(kind.error());
  PlanningOutcome outcome;
  outcome.design_kind = std::string(name_of(*kind));
  Result<std::string> preview;
  if (*kind == InputKind::Spec) {
    const auto spec = parse_design_spec(task.design);
    if (!spec) return tl::unexpected(spec.error());
    auto ids = asset_ids(*spec);
    if (!ids) return tl::unexpected(ids.error());
    outcome.assets = std::move(*ids);
    preview = spec_preview(*spec, task, outcome.warnings);
  } else {
    auto profile = find_stroke_profile("popcut");
    if (!profile) return tl::unexpected(profile.error());
    SvgReadOptions how;
    how.profile = std::move(*profile);
    const auto drawn = drawing_from_text(std::move(task.design), *kind, how, 1, {});
    if (!drawn) return tl::unexpected(drawn.error());
    outcome.warnings = drawn->drawing.warnings;
    preview = preview_svg(drawn->drawing);
  }
  if (!preview) return tl::unexpected(preview.error());
  if (auto done = add("preview.svg", std::move(*preview)); !done)
    return tl::unexpected(done.error());
  return outcome;
}

Result<PlanningOutcome> draw_pdf(const WorkerTask& task, const FileSink& add) {
  std::uint64_t number = 0;
  const std::string& text = task.options.at("page");
  std::from_chars(text.data(), text.data() + text.size(), number);
  auto page = pictures::pdf_page(task.design, number);
  if (!page) return tl::unexpected(page.error());
  if (auto done = add("drawing.svg", std::move(page->svg)); !done)
    return tl::unexpected(done.error());
  PlanningOutcome outcome;
  outcome.warnings = std::move(page->warnings);
  return outcome;
}

}  // namespace

Result<PlanningOutcome> perform(WorkerTask task, const FileSink& add, const Progress& progress) {
  switch (task.kind) {
    case Kind::Check:
      return check(task, add);
    case Kind::Plan:
    case Kind::TestCut:
      return make_plan(task, add, progress);
    case Kind::Preview:
    case Kind::Lattice:
    case Kind::Place:
    case Kind::Picture:
    case Kind::Export:
      return show(task, add);
    case Kind::Artwork:
      return draw_artwork(task, add, progress);
    case Kind::Svg:
      return draw_pdf(task, add);
    case Kind::Make:
      return make_sheets(task, add, progress);
    case Kind::Search:
      break;  // planning/search, which rests on this folder; the worker has it do the task
  }
  return fail(ErrorKind::Internal, "worker", "does not know this task");
}

}  // namespace popcut::planning
