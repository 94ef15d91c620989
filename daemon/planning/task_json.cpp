// SPDX-License-Identifier: MIT
#include "daemon/planning/task_json.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <nlohmann/json.hpp>

#include "core/text/field_reader.hpp"
#include "core/text/json_text.hpp"
#include "daemon/model/fields.hpp"
#include "daemon/model/job_parts.hpp"
#include "daemon/model/warnings.hpp"

namespace popcut::planning {
namespace {

using Json = nlohmann::ordered_json;
using daemon::PlanningOutcome;

constexpr auto kLastKind = daemon::PlanningTask::Kind::Search;
constexpr double kMost = 1e12;
constexpr std::size_t kMostName = 100;
constexpr std::size_t kMostDoing = 100;
constexpr std::size_t kMostText = 10'000;  ///< characters of a warning or an error

/// How what is done begins, in the order of planning.
constexpr std::pair<std::string_view, std::string_view> kPhases[] = {
    {"reading", "reading"},
    {"cutting the shape", "slicing"},
    {"fitting", "slicing"},
    {"laying the lattice", "lattice"},
    {"building the pattern", "lattice"},
    {"measuring", "checking"},
    {"counting", "checking"},
    {"checking", "checking"},
    {"cleaning", "cleaning"},
    {"splitting", "splitting"},
    {"drawing the folds", "toolpath"},
    {"ordering the cuts", "toolpath"},
    {"making the strokes", "toolpath"},
    {"writing", "writing"},
    {"trying ways", "searching"},
    {"designing", "searching"},
    {"verifying", "searching"},
};

Json sheet_json(const daemon::SheetPlan& sheet) {
  Json out;
  list_fields(&sheet, [&](const char* name, auto member, daemon::FieldUse use = {}) {
    if (!use.is_hidden) out[name] = sheet.*member;
  });
  return out;
}

void read_member(FieldReader& fields, const char* name, int& value) {
  value = fields.integer(name, {}, 0, 1 << 30);
}
void read_member(FieldReader& fields, const char* name, double& value) {
  value = fields.number(name, {}, 0, kMost);
}
void read_member(FieldReader& fields, const char* name, std::array<double, 2>& pair) {
  const std::vector<double> both = fields.numbers(name, 2);
  pair = {both[0], both[1]};
}
void read_member(FieldReader& fields, const char* name, std::string& text) {
  text = fields.text(name, {}).substr(0, kMostName);
}

daemon::SheetPlan read_sheet(FieldReader& fields) {
  daemon::SheetPlan sheet;
  list_fields(&sheet, [&](const char* name, auto member, daemon::FieldUse use = {}) {
    if (!use.is_hidden) read_member(fields, name, sheet.*member);
  });
  return sheet;
}

std::vector<std::string> read_texts(FieldReader& fields, const char* key) {
  fields.need(key, "must be a list of texts");
  std::vector<std::string> texts = fields.optional_texts(key).value_or(std::vector<std::string>());
  for (std::string& text : texts) text.resize(std::min(text.size(), kMostText));
  return texts;
}

}  // namespace

std::string task_json(const WorkerTask& task) {
  return json_line(Json{{"kind", static_cast<int>(task.kind)},
                        {"design_kind", task.design_kind},
                        {"machine", task.machine_json},
                        {"material", task.material_json},
                        {"profile", task.profile_json},
                        {"options", task.options}});
}

Result<WorkerTask> read_task(std::string_view json) {
  const auto parsed = parse_json(json, 4);
  if (!parsed) return tl::unexpected(parsed.error());
  FieldReader fields(*parsed, "");
  WorkerTask task;
  task.kind = static_cast<daemon::PlanningTask::Kind>(
      fields.integer("kind", {}, 0, static_cast<int>(kLastKind)));
  task.design_kind = fields.text("design_kind", {});
  task.machine_json = fields.text("machine", {});
  task.material_json = fields.text("material", {});
  task.profile_json = fields.text("profile", {});
  fields.optional_object("options", [&](FieldReader& options) {
    for (const auto& [name, value] : parsed->at("options").items())
      task.options[name] = options.text(name, {});
  });
  if (const auto whole = fields.finish(); !whole) return tl::unexpected(whole.error());
  return task;
}

std::string outcome_json(const PlanningOutcome& outcome) {
  Json sheets = Json::array();
  for (const daemon::SheetPlan& sheet : outcome.sheets) sheets.push_back(sheet_json(sheet));
  return json_line(Json{
      {"design_kind", outcome.design_kind},
      {"assets", outcome.assets},
      {"sheets", sheets},
      {"warnings", daemon::warnings_json(outcome.warnings)},
      {"handwork", outcome.handwork ? daemon::json_of(*outcome.handwork).whole() : std::string()},
      {"sha256", outcome.sha256}});
}

Result<PlanningOutcome> read_outcome(std::string_view json) {
  const auto parsed = parse_json(json, 8);
  if (!parsed) return tl::unexpected(parsed.error());
  FieldReader fields(*parsed, "");
  PlanningOutcome outcome;
  outcome.design_kind = fields.text("design_kind", {});
  outcome.assets = read_texts(fields, "assets");
  outcome.warnings = daemon::warnings_from_json(fields.text("warnings", {}));
  if (const std::string work = fields.text("handwork", {}).substr(0, kMostText); !work.empty())
    outcome.handwork = daemon::handwork_from_json(work);
  outcome.sha256 = fields.text("sha256", {});
  fields.objects("sheets",
                 [&](FieldReader& sheet) { outcome.sheets.push_back(read_sheet(sheet)); });
  if (const auto whole = fields.finish(); !whole) return tl::unexpected(whole.error());
  return outcome;
}

std::string error_json(const Error& error) {
  return json_line(Json{{"kind", static_cast<int>(error.kind)},
                        {"place", error.place.substr(0, kMostText)},
                        {"detail", error.detail.substr(0, kMostText)}});
}

Error read_error(std::string_view json) {
  const auto parsed = parse_json(json, 2);
  if (!parsed) return {ErrorKind::Internal, "worker", "its error cannot be read"};
  FieldReader fields(*parsed, "");
  Error error;
  error.kind = static_cast<ErrorKind>(
      fields.integer("kind", {}, 0, static_cast<int>(ErrorKind::Unwritable)));
  error.place = fields.text("place", {});
  error.detail = fields.text("detail", {});
  if (!fields.finish() || error.detail.empty())
    return {ErrorKind::Internal, "worker", "its error cannot be read"};
  return error;
}

std::string_view phase_of(std::string_view doing) {
  for (const auto& [beginning, phase] : kPhases)
    if (doing.starts_with(beginning)) return phase;
  return "planning";
}

std::string phase_json(std::string_view doing, double done) {
  const Json json{
      {"doing", std::string(doing.substr(0, kMostDoing))},
      {"done", std::isfinite(done) ? std::clamp(done, kUnknownPart, 1.0) : kUnknownPart}};
  return json_line(json);
}

std::optional<daemon::PlanningPhase> read_phase(std::string_view json) {
  const auto parsed = parse_json(json, 2);
  if (!parsed || !parsed->is_object()) return std::nullopt;
  FieldReader fields(*parsed, "");
  daemon::PlanningPhase phase;
  phase.doing = fields.text("doing", {}).substr(0, kMostDoing);
  phase.done = fields.number("done", {}, kUnknownPart, 1.0);
  if (!fields.finish() || phase.doing.empty()) return std::nullopt;
  for (char& c : phase.doing)
    if (c < 0x20 || c > 0x7E) c = '?';
  phase.phase = phase_of(phase.doing);
  return phase;
}

}  // namespace popcut::planning
