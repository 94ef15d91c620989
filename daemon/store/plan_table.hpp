// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/model/model.hpp"
#include "daemon/store/attempt_table.hpp"
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
  std::vector<Warning> warnings{};
  std::string error{};
  std::string options{"{}"};  ///< JSON object of words
  std::string machine_json{}, material_json{};
  TimeMs created{};
  int begun{0};           ///< how often a planner had it and popcutd ended before the planner did
  std::string planner{};  ///< in a fleet: the node that makes it; empty: nobody does
  std::optional<Handwork> handwork{};
};

/// The statements over `plan` and `plan_sheet`. All throw StoreFault.
class PlanTable {
 public:
  explicit PlanTable(Database& database) : db_(database) {}

  void insert(const PlanRow& row);
  /// Stores some of the sheets of a plan that is not finished yet.
  void put_sheets(std::string_view plan, std::span<const SheetPlan> sheets);
  /// The plan is made, with `row.sheets` sheets that are stored already, or it failed.
  void finish(const PlanRow& row);
  /// Takes a plan that nobody makes, and counts that it is begun. False: another node was quicker.
  [[nodiscard]] bool claim(std::string_view plan, const NodeMark& node);
  /// Nobody makes it any more. `begun` is how often it was begun in vain.
  void give_back(std::string_view plan, int begun);

  /// Notes that `owner` waits for a plan.
  void ask(std::string_view plan, std::string_view owner);
  /// `owner` does not wait for it any more.
  void unask(std::string_view plan, std::string_view owner);
  [[nodiscard]] bool has_asked(std::string_view plan, std::string_view owner);
  /// For how many plans `owner` waits.
  [[nodiscard]] std::int64_t asked_by(std::string_view owner);
  /// The next after `owner` among those who wait for plans, by name; nothing after the last.
  [[nodiscard]] std::optional<std::string> asker_after(std::string_view owner);
  /// Plans that `owner` waits for: first those of their queued jobs, in the order of the queue.
  [[nodiscard]] std::vector<std::string> wanted_by(std::string_view owner, int limit);
  [[nodiscard]] std::optional<PlanRow> find(std::string_view id);
  /// The pending or planned one of that key.
  [[nodiscard]] std::optional<PlanRow> find_key(std::string_view key);
  /// Ids of those that wait to be made, the oldest first.
  [[nodiscard]] std::vector<std::string> pending(int limit);
  /// Up to `limit` sheets with numbers above `after`.
  [[nodiscard]] std::vector<SheetPlan> sheets(std::string_view plan, int after, int limit);
  [[nodiscard]] std::optional<SheetPlan> sheet(std::string_view plan, int number);

 private:
  Database& db_;
};

/// A list of texts as a JSON array, and back.
/// @throws StoreFault  Corrupt, if it is none
[[nodiscard]] std::string json_list(const std::vector<std::string>& texts);
[[nodiscard]] std::vector<std::string> list_from_json(const std::string& json);

}  // namespace popcut::daemon
