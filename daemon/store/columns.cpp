// SPDX-License-Identifier: MIT
#include "daemon/store/columns.hpp"

#include <fmt/format.h>

#include "daemon/model/job_parts.hpp"
#include "daemon/model/warnings.hpp"
#include "daemon/store/plan_table.hpp"

namespace popcut::daemon {

void ColumnValues::put(const std::vector<std::string>& texts) {
  texts.empty() ? put(std::string_view("[]")) : put_own(json_list(texts));
}

void ColumnValues::put(const std::vector<Warning>& warnings) {
  warnings.empty() ? put(std::string_view("[]")) : put_own(warnings_json(warnings));
}

void ColumnValues::put(const std::optional<LoadedSheet>& load) {
  load ? put_own(json_of(*load).whole()) : put(std::string_view());
}

void ColumnValues::put(const std::optional<Handwork>& work) {
  work ? put_own(json_of(*work).whole()) : put(std::string_view());
}

void ColumnReader::take(JobState& state) {
  const std::string word = rows_.text(at_++);
  const auto found = job_state_from(word);
  if (!found) throw StoreFault(FaultKind::Corrupt, fmt::format("a job's state is {:?}", word));
  state = *found;
}

void ColumnReader::take(PlanState& state) {
  const std::string word = rows_.text(at_++);
  const auto found = plan_state_from(word);
  if (!found) throw StoreFault(FaultKind::Corrupt, fmt::format("a plan's state is {:?}", word));
  state = *found;
}

void ColumnReader::take(std::vector<std::string>& texts) {
  const std::string json = rows_.text(at_++);
  if (json != "[]") texts = list_from_json(json);
}

void ColumnReader::take(std::vector<Warning>& warnings) {
  const std::string json = rows_.text(at_++);
  if (json != "[]") warnings = warnings_from_json(json);
}

void ColumnReader::take(std::optional<LoadedSheet>& load) {
  const std::string json = rows_.text(at_++);
  if (!json.empty()) load = loaded_sheet_from_json(json);
}

void ColumnReader::take(std::optional<Handwork>& work) {
  const std::string json = rows_.text(at_++);
  if (!json.empty()) work = handwork_from_json(json);
}

}  // namespace popcut::daemon
