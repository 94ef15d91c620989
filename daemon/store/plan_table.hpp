// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/model/model.hpp"
#include "daemon/store/database.hpp"

namespace popcut::daemon {

/// A row of the table of plans, without its sheets.
struct PlanRow {
  std::string id, key;
  std::string kind{"design"};  ///< "design" or "test"
  std::string design{}, material{}, machine{};
  PlanState state{};
  std::string sha256{};
  int sheets{};
  std::int64_t paths{};
  double cut_mm{}, low_s{}, high_s{};
  double width_mm{}, length_mm{};  ///< that the largest sheet needs
  std::vector<std::string> warnings{};
  std::string error{};
  std::string options{"{}"};  ///< JSON object of words
  std::string machine_json{}, material_json{};
  TimeMs created{};
};

/// The statements over `plan` and `plan_sheet`. All throw StoreFault.
class PlanTable {
 public:
  explicit PlanTable(Database& database) : db_(database) {}

  void insert(const PlanRow& row);
  void finish(const PlanRow& row, const std::vector<SheetPlan>& sheets);
  [[nodiscard]] std::optional<PlanRow> find(std::string_view id);
  /// The pending or planned one of that key.
  [[nodiscard]] std::optional<PlanRow> find_key(std::string_view key);
  /// Ids of those that wait to be made, the oldest first.
  [[nodiscard]] std::vector<std::string> pending(int limit);
  [[nodiscard]] std::vector<SheetPlan> sheets(std::string_view plan);
  [[nodiscard]] std::optional<SheetPlan> sheet(std::string_view plan, int number);

 private:
  Database& db_;
};

[[nodiscard]] std::string_view name_of(PlanState state);

/// A list of texts as a JSON array, and back.
/// @throws StoreFault  Corrupt, if it is none
[[nodiscard]] std::string json_list(const std::vector<std::string>& texts);
[[nodiscard]] std::vector<std::string> list_from_json(const std::string& json);

}  // namespace popcut::daemon
