// SPDX-License-Identifier: MIT
// Part of daemon/planning/work.hpp. Sheets for people who have no cutter that popcut drives.
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/hands/folding.hpp"
#include "core/print/drawn_letters.hpp"
#include "core/print/pages.hpp"
#include "core/text/words.hpp"
#include "daemon/digest/digest.hpp"
#include "daemon/pictures/pdf.hpp"
#include "daemon/planning/make/drawing_question.hpp"
#include "daemon/planning/make/make_ways.hpp"
#include "daemon/planning/make/program_sheets.hpp"
#include "daemon/planning/task_inputs.hpp"
#include "daemon/planning/work.hpp"

namespace popcut::planning {
namespace {

using Json = nlohmann::ordered_json;
using daemon::PlanningOutcome;

constexpr std::size_t kMostPictures = 6;  // of sheets, in one document

double rounded_mm(double mm) { return std::round(mm * 1e6) / 1e6; }

std::string dumped(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Json text_file(std::string name, std::string_view type, std::string text) {
  return {{"name", std::move(name)}, {"type", type}, {"text", std::move(text)}};
}

/// The pages as `popcut plan` writes them, but letters are lines: a worker reads no fonts.
Result<std::vector<PrintedPage>> pages_of(const Plan& plan) {
  auto pages = sheet_pages(plan);
  if (pages)
    for (PrintedPage& page : *pages) page.svg = with_drawn_letters(page.svg);
  return pages;
}

Result<Json> pages_file(const std::vector<PrintedPage>& pages, const std::string& title) {
  const auto pdf = pdf_of_pages(pages, title);
  if (!pdf) return tl::unexpected(pdf.error());
  return Json{
      {"name", "sheets.pdf"},
      {"type", "application/pdf"},
      {"base64", daemon::base64(*pdf)},
      {"page_mm", {rounded_mm(pages.front().width_mm), rounded_mm(pages.front().height_mm)}}};
}

/// @param pages  printed; empty unless the way is by hand
Result<Json> files_of_way(const PlanJob& job, const MakeWay& way,
                          const std::vector<PrintedPage>& pages) {
  Json files = Json::array();
  std::string_view rest = way.formats;
  for (std::string_view format; !(format = take_word(rest, ",")).empty();) {
    if (format == "pdf") {
      auto file = pages_file(pages, job.plan.name);
      if (!file) return file;
      files.push_back(std::move(*file));
      continue;
    }
    const std::string_view program = format == "laser" ? "lightburn" : format;
    for (std::size_t i = 0; i < job.plan.sheets.size(); ++i) {
      const std::string title = fmt::format("{}: sheet {}", job.plan.name, i + 1);
      if (format == "svg") {
        files.push_back(text_file(PlanJob::sheet_file(i, "svg"), "image/svg+xml",
                                  sheet_svg(job.plan.sheets[i], title)));
        continue;
      }
      auto sheet = program_sheet(job.plan, i + 1, program, title);
      if (!sheet) return tl::unexpected(sheet.error());
      files.push_back(text_file(program_sheet_name(i + 1, program),
                                program == kDxfSheets ? "application/dxf" : "image/svg+xml",
                                std::move(sheet->value())));
    }
  }
  return files;
}

/// With pictures as they are printed, if they are, else of what is cut.
Json sheets_json(const Plan& plan, const std::vector<PrintedPage>& pages) {
  Json sheets = Json::array();
  for (std::size_t i = 0; i < plan.sheets.size(); ++i) {
    const PlannedSheet& sheet = plan.sheets[i];
    const Box box = bounds(strokes_as_lines(sheet, plan.folds, ""));
    sheets.push_back({{"area_mm", {rounded_mm(sheet.area_mm[0]), rounded_mm(sheet.area_mm[1])}},
                      {"size_mm", {rounded_mm(box.width()), rounded_mm(box.height())}},
                      {"cut_mm", rounded_mm(sheet.cut_mm)},
                      {"fold_mm", rounded_mm(sheet.fold_line_mm)},
                      {"picture", i >= kMostPictures ? ""
                                  : pages.empty()    ? sheet_svg(sheet, "")
                                                     : pages[i].svg}});
  }
  return sheets;
}

/// The command that writes the same files.
std::string command_of(const WorkerTask& task, const MakeWay& way, const Plan& plan) {
  std::string out = "popcut plan FILE -o sheets";
  if (!task.machine_json.empty()) out += " --machine " + plan.machine.name;
  out += " --material " + plan.material.name;
  for (const auto& [name, value] : task.options) {
    if (value == "false" || value.empty()) continue;
    out += " --" + name;
    if (value != "true") out += fmt::format(" \"{}\"", value);
  }
  return out + fmt::format(" --formats {}", way.formats);
}

Result<std::string> question_of(const WorkerTask& task) {
  const auto options = read_plan_options(task.options);
  if (!options) return tl::unexpected(in_request(options.error()));
  const auto tables = tables_of(task);
  if (!tables) return tl::unexpected(tables.error());
  const auto kind =
      task.design_kind.empty() ? kind_of_content(task.design) : input_kind_from(task.design_kind);
  if (!kind) return tl::unexpected(kind.error());
  if (*kind == InputKind::Spec)
    return fail(ErrorKind::OutOfRange, "", "is a spec, whose lines all have a meaning");
  auto how = read_options(*options, tables->texts);
  if (!how) return tl::unexpected(in_request(how.error()));
  auto question = drawing_question(task.design, *kind, std::move(*how));
  if (!question) return tl::unexpected(in_request(question.error()));
  return question;
}

}  // namespace

Result<PlanningOutcome> make_sheets(WorkerTask& task, const FileSink& add,
                                    const Progress& progress) {
  PlanningOutcome outcome;
  const auto named = task.options.extract(std::string(kMakeOption) + "way");
  const std::string word = named ? named.mapped() : "";
  const auto answer = [&](std::string document) -> Result<PlanningOutcome> {
    if (auto done = add(kMakeFile, std::move(document)); !done) return tl::unexpected(done.error());
    return outcome;
  };
  if (word == "drawing") {
    auto question = question_of(task);
    if (!question) return tl::unexpected(question.error());
    return answer(std::move(*question));
  }
  const MakeWay* const way = find_make_way(word);
  if (way == nullptr) return fail(ErrorKind::OutOfRange, "/way", "is no way of making");
  if (!way->mat.empty()) task.options.try_emplace("mat", way->mat);
  if (!way->folds.empty()) task.options.try_emplace("folds", way->folds);
  const WorkerTask again = task;  // planning takes the design out of the task
  const auto job = planned(task, outcome, {}, progress, true);
  if (!job && job.error().reason == ErrorReason::Unclear) {
    auto question = question_of(again);
    if (!question) return tl::unexpected(question.error());
    return answer(fmt::format("{{\"asks\":{},\"detail\":{}}}", *question,
                              dumped(Json(message(job.error())))));
  }
  if (!job) return tl::unexpected(job.error());
  std::vector<PrintedPage> printed;
  if (way->formats == "pdf") {
    auto pages = pages_of(job->plan);
    if (!pages) return tl::unexpected(pages.error());
    printed = std::move(*pages);
  }
  auto files = files_of_way(*job, *way, printed);
  if (!files) return tl::unexpected(files.error());
  Json warnings = Json::array();
  for (const Warning& one : job->plan.warnings) warnings.push_back(one.message);
  const auto& work = job->plan.handwork;
  return answer(dumped({{"way", way->name},
                        {"machine", job->plan.machine.title},
                        {"material", job->plan.material.title},
                        {"sheets", sheets_json(job->plan, printed)},
                        {"files", std::move(*files)},
                        {"handwork", work ? Json(hands::handwork_words(*work)) : Json()},
                        {"warnings", std::move(warnings)},
                        {"command", command_of(task, *way, job->plan)}}));
}

}  // namespace popcut::planning
