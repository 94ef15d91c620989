// SPDX-License-Identifier: MIT
#include "daemon/planning/task_json.hpp"

#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/text/json_fields.hpp"

namespace popcut::planning {
namespace {

using Json = nlohmann::ordered_json;
using daemon::PlanningOutcome;

constexpr double kMost = 1e12;
constexpr std::size_t kMostText = 10'000;  ///< characters of a warning or an error

/// Text may hold bytes of a hostile file that are no UTF-8.
std::string dumped(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Json sheet_json(const daemon::SheetPlan& sheet) {
  return {{"number", sheet.number},
          {"paths", sheet.paths},
          {"cut_mm", sheet.cut_mm},
          {"fold_mm", sheet.fold_mm},
          {"travel_mm", sheet.travel_mm},
          {"seconds", sheet.seconds},
          {"seconds_range", sheet.seconds_range},
          {"area_mm", sheet.area_mm},
          {"program_sha256", sheet.program_sha256}};
}

std::array<double, 2> read_pair(JsonFields& fields, const char* key) {
  const nlohmann::json* pair = fields.value(key);
  if (pair == nullptr || !pair->is_array() || pair->size() != 2 || !(*pair)[0].is_number() ||
      !(*pair)[1].is_number()) {
    fields.add_error(ErrorKind::Malformed, fields.pointer(key), "two numbers are needed");
    return {};
  }
  return {(*pair)[0].get<double>(), (*pair)[1].get<double>()};
}

daemon::SheetPlan read_sheet(JsonFields& fields) {
  daemon::SheetPlan sheet;
  sheet.number = fields.integer("number", {}, 1, 1'000'000);
  sheet.paths = fields.integer("paths", {}, 0, 1 << 30);
  sheet.cut_mm = fields.number("cut_mm", {}, 0, kMost);
  sheet.fold_mm = fields.number("fold_mm", {}, 0, kMost);
  sheet.travel_mm = fields.number("travel_mm", {}, 0, kMost);
  sheet.seconds = fields.number("seconds", {}, 0, kMost);
  sheet.seconds_range = read_pair(fields, "seconds_range");
  sheet.area_mm = read_pair(fields, "area_mm");
  sheet.program_sha256 = fields.text("program_sha256", {});
  return sheet;
}

std::vector<std::string> read_texts(JsonFields& fields, const char* key) {
  std::vector<std::string> texts;
  const nlohmann::json* list = fields.value(key);
  const bool lawful = list != nullptr && list->is_array();
  if (!lawful)
    fields.add_error(ErrorKind::Malformed, fields.pointer(key), "a list of texts is needed");
  for (std::size_t i = 0; lawful && i < list->size(); ++i) {
    const nlohmann::json& text = (*list)[i];
    if (text.is_string())
      texts.push_back(text.get_ref<const std::string&>().substr(0, kMostText));
    else
      fields.add_error(ErrorKind::Malformed, fields.pointer(key), "a list of texts is needed");
  }
  return texts;
}

}  // namespace

std::string task_json(const WorkerTask& task) {
  return dumped({{"kind", static_cast<int>(task.kind)},
                 {"design_kind", task.design_kind},
                 {"machine", task.machine_json},
                 {"material", task.material_json},
                 {"profile", task.profile_json},
                 {"options", task.options}});
}

Result<WorkerTask> read_task(std::string_view json) {
  const auto parsed = parse_json(json, 4);
  if (!parsed) return tl::unexpected(parsed.error());
  JsonFields fields(*parsed, "");
  WorkerTask task;
  task.kind = static_cast<daemon::PlanningTask::Kind>(fields.integer("kind", {}, 0, 2));
  task.design_kind = fields.text("design_kind", {});
  task.machine_json = fields.text("machine", {});
  task.material_json = fields.text("material", {});
  task.profile_json = fields.text("profile", {});
  const nlohmann::json* options = fields.value("options");
  if (options != nullptr && options->is_object())
    for (const auto& [name, value] : options->items()) {
      if (value.is_string())
        task.options[name] = value.get<std::string>();
      else
        fields.add_error(ErrorKind::Malformed, "/options/" + name, "a text is needed");
    }
  if (const auto whole = fields.finish(); !whole) return tl::unexpected(whole.error());
  return task;
}

std::string outcome_json(const PlanningOutcome& outcome) {
  Json sheets = Json::array();
  for (const daemon::SheetPlan& sheet : outcome.sheets) sheets.push_back(sheet_json(sheet));
  return dumped({{"design_kind", outcome.design_kind},
                 {"assets", outcome.assets},
                 {"sheets", sheets},
                 {"warnings", outcome.warnings},
                 {"sha256", outcome.sha256}});
}

Result<PlanningOutcome> read_outcome(std::string_view json) {
  const auto parsed = parse_json(json, 8);
  if (!parsed) return tl::unexpected(parsed.error());
  JsonFields fields(*parsed, "");
  PlanningOutcome outcome;
  outcome.design_kind = fields.text("design_kind", {});
  outcome.assets = read_texts(fields, "assets");
  outcome.warnings = read_texts(fields, "warnings");
  outcome.sha256 = fields.text("sha256", {});
  const nlohmann::json* sheets = fields.value("sheets");
  if (sheets == nullptr || !sheets->is_array())
    return fail(ErrorKind::Malformed, "/sheets", "a list of sheets is needed");
  for (std::size_t i = 0; i < sheets->size(); ++i) {
    JsonFields row((*sheets)[i], fmt::format("/sheets/{}", i));
    outcome.sheets.push_back(read_sheet(row));
    if (const auto whole = row.finish(); !whole) return tl::unexpected(whole.error());
  }
  if (const auto whole = fields.finish(); !whole) return tl::unexpected(whole.error());
  return outcome;
}

std::string error_json(const Error& error) {
  return dumped({{"kind", static_cast<int>(error.kind)},
                 {"place", error.place.substr(0, kMostText)},
                 {"detail", error.detail.substr(0, kMostText)}});
}

Error read_error(std::string_view json) {
  const auto parsed = parse_json(json, 2);
  if (!parsed) return {ErrorKind::Internal, "worker", "its error cannot be read"};
  JsonFields fields(*parsed, "");
  Error error;
  error.kind = static_cast<ErrorKind>(
      fields.integer("kind", {}, 0, static_cast<int>(ErrorKind::Unwritable)));
  error.place = fields.text("place", {});
  error.detail = fields.text("detail", {});
  if (!fields.finish() || error.detail.empty())
    return {ErrorKind::Internal, "worker", "its error cannot be read"};
  return error;
}

}  // namespace popcut::planning
