// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "daemon/service/repositories/planning_queue.hpp"

namespace popcut::daemon {

/// Searches for the best cards of a model. The same model and options are searched once. One search
/// runs at a time; owners take turns. Waiting searches are in the store only.
class SearchRepository : public Searches {
 public:
  struct Parts {
    ServiceStore& store;
    Poster post;
    Planner& planner;
    Aside& aside;
    DesignRepository& designs;
    PlanningQueue& plans;
    const ServiceOptions& options;
  };
  explicit SearchRepository(Parts parts) : parts_(std::move(parts)) {}

  Answer<SearchRecord> request(const Principal& who, const CardSearchRequest& request) override;
  Answer<SearchRecord> find(const std::string& id) override;
  Answer<void> remove(const Principal& who, const std::string& id) override;
  Answer<std::string> picture(const std::string& id, int card) override;
  void pick(const Principal& who, const std::string& id, int card, const std::string& name,
            std::function<void(Answer<Design>)> done) override;

  /// Gives the planner the next search, unless it has one.
  void pump();
  /// Removes all searches of a model, in the transaction that removes the model.
  void remove_all_of(const std::string& model);
  void stop() { stopped_ = true; }

 private:
  /// A row of the table of searches.
  struct Row {
    std::string id, key, owner, model, words, machine, material, machine_json, material_json;
    std::string front, error, planner;
    SearchState state{};
    TimeMs created{};
    int begun{};
  };
  /// The search that the planner has.
  struct Running {
    std::string id;
    std::uint64_t task{};
    PlanningPhase phase{};
  };
  [[nodiscard]] static Row row_of(const Rows& rows);
  [[nodiscard]] std::optional<Row> row(const std::string& id);
  /// The search with this key that is pending or found.
  [[nodiscard]] std::optional<Row> row_of_key(const std::string& key);
  [[nodiscard]] Answer<Row> found_row(const std::string& id);
  [[nodiscard]] Answer<Row> row_for(const Principal& who, const CardSearchRequest& request);
  [[nodiscard]] Answer<Row> find_or_add(const Principal& who, Row row);
  struct Picked {
    std::string name;  ///< of the model
    FoundCardRecord card;
  };
  [[nodiscard]] Answer<Picked> card_of(const std::string& id, int card);
  [[nodiscard]] SearchRecord record_of(const Row& row) const;
  [[nodiscard]] std::string next();
  [[nodiscard]] bool start(const std::string& id);
  [[nodiscard]] Answer<PlanningTask> task_of(const Row& row);
  void over(const std::string& id, const Result<SearchFront>& found);
  void finish(const std::string& id, SearchState state, const std::string& front,
              const std::string& error);
  void forget(const std::string& id);
  [[nodiscard]] std::string folder_of(const std::string& id) const;

  Parts parts_;
  std::optional<Running> running_{};
  std::string turn_of_{};  ///< whose search began last
  bool stopped_{false};
};

}  // namespace popcut::daemon
