// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "daemon/service/repositories/planning_queue.hpp"

namespace popcut::daemon {

/// Searches for the best cards of a model. The same model with the same options is searched once.
/// One search runs at a time, and owners take turns. Only the store knows the searches that wait.
class SearchRepository : public Searches {
 public:
  struct Parts {
    ServiceStore& store;
    Poster post;
    Planner& planner;
    SideThread& side_thread;
    DesignRepository& designs;
    PlanningQueue& plans;
    const ServiceOptions& options;
  };
  explicit SearchRepository(Parts parts) : parts_(std::move(parts)) {}

  Answer<SearchRecord> request(const Principal& who, const CardSearchRequest& request) override;
  Answer<SearchRecord> find(const Principal& who, const std::string& id) override;
  Page<SearchRecord> list(const Principal& who, const PageRequest& request) override;
  Answer<void> remove(const Principal& who, const std::string& id) override;
  Answer<std::string> picture(const std::string& id, int card) override;
  Answer<std::string> lattice(const std::string& id, int card) override;
  void pick(const Principal& who, const std::string& id, int card, const std::string& name,
            std::function<void(Answer<Design>)> done) override;

  /// Starts the next search, unless one is running. First stores a result where that failed before.
  void pump();
  /// Removes the searches of a model that nobody owns. Call this in the transaction that removes
  /// the model or one of its owners.
  void remove_unowned(const std::string& model);
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
  [[nodiscard]] Answer<Row> find_or_add(const Principal& who, Row row, const std::string& label);
  struct Picked {
    std::string name;  ///< of the model
    FoundCardRecord card;
  };
  [[nodiscard]] Answer<Picked> card_of(const std::string& id, int card);
  /// The record as `who` sees it. It has a front only if the row has one.
  [[nodiscard]] SearchRecord record_of(const Principal& who, const Row& row) const;
  [[nodiscard]] bool is_owned(const Row& row, const std::string& owner) const;
  /// Path of a file of a card.
  ///
  /// @param what  names the file in errors
  [[nodiscard]] Answer<std::string> file_of(const std::string& id, int card,
                                            const std::string& name, std::string_view what);
  [[nodiscard]] std::string next();
  [[nodiscard]] Begun start(const std::string& id);
  [[nodiscard]] Answer<PlanningTask> task_of(const Row& row);
  void task_ended(const std::string& id, const Result<SearchFront>& found);
  /// False if that could not be stored.
  bool finish(const std::string& id, SearchState state, const std::string& front,
              const std::string& error);
  bool pass_to_next_owner(const std::string& id);
  void delete_search(const std::string& id);
  [[nodiscard]] std::string folder_of(const std::string& id) const;

  Parts parts_;
  std::optional<Running> running_{};
  std::optional<SearchFront> unstored_{};  ///< what it found, if that could not be stored yet
  std::string turn_of_{};                  ///< whose search began last
  bool stopped_{false};
};

}  // namespace popcut::daemon
