// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>

#include "daemon/service/repositories/design_repository.hpp"
#include "daemon/service/repositories/device_registry.hpp"
#include "daemon/service/repositories/material_repository.hpp"
#include "daemon/store/plan_table.hpp"

namespace popcut::daemon {

/// The result of an attempt to begin a plan or a search.
enum class Begun : std::uint8_t {
  Yes,
  Not,    ///< this one did not begin; try another
  Later,  ///< nothing can begin now: a file is being fetched, or nothing can be stored
};

/// A plan or search fails after it was begun so often, because popcutd ended each time before it
/// was made. It may be what ends popcutd.
[[nodiscard]] constexpr int most_begun(bool in_fleet) { return in_fleet ? 3 : 10; }

/// Plans. The same design with the same options is planned once. A few plans are made at the same
/// time. The principals who wait take turns, and each gets the plans of their jobs in the order of
/// the queue. Only the store knows the plans that wait; this class knows those that the planner
/// makes.
class PlanningQueue : public Plans {
 public:
  struct Parts {
    ServiceStore& store;
    Poster post;
    Planner& planner;
    SideThread& side_thread;
    DesignRepository& designs;
    MaterialRepository& materials;
    DeviceRegistry& devices;
    const ServiceOptions& options;
  };
  explicit PlanningQueue(Parts parts) : parts_(std::move(parts)), plans_(parts_.store.db()) {}

  Answer<PlanRecord> request(const Principal& who, const PlanRequest& request) override;
  Answer<PlanRecord> find(const std::string& id) override;
  void whole(const std::string& id, std::function<void(Answer<PlanRecord>)> done) override;
  Answer<std::vector<popcut::Machine>> machines() override;
  Answer<std::string> file(const std::string& id, const std::string& name) override;
  Answer<void> remove(const Principal& who, const std::string& id) override;
  Designs::CancelView make(const Principal& who, const std::string& way, const PlanRequest& request,
                           Designs::OnView done) override;
  Designs::CancelView artwork(const Principal& who, const std::string& id, int sheet,
                              const ArtworkRequest& wanted, Designs::OnView done) override;

  /// The plan for a request, in a transaction. It exists already, or is made after the commit.
  ///
  /// @retval QueueFull  too many plans wait, of all or of this principal
  [[nodiscard]] Answer<PlanRow> plan_for(const Principal& who, const PlanRequest& request);
  /// A plan with the design and the options of an earlier one.
  ///
  /// @param device    if empty, one at `site` that suits the material
  /// @param material  if empty, that of the earlier plan
  [[nodiscard]] Answer<PlanRow> plan_again(const Principal& who, const PlanRow& before,
                                           const std::string& device, const std::string& material,
                                           const std::string& site);
  /// The plan of a small test shape.
  [[nodiscard]] Answer<PlanRow> test_plan_for(const Principal& who, const std::string& device,
                                              const std::string& material,
                                              const std::string& site = {});
  /// Makes `who` an owner of a plan and of its design, in a transaction. If the plan is not made
  /// yet, `who` waits for it.
  ///
  /// @retval QueueFull  `who` waits for too many plans
  [[nodiscard]] Answer<void> add_waiting(const Principal& who, const PlanRow& plan);
  /// Among the plans of `owner`, puts this one before those for which only jobs wait.
  void hurry(const std::string& plan, const std::string& owner);
  /// Starts plans until `plans_at_once` of them are being made. First stores results and releases
  /// plans where that failed before.
  void pump();
  /// Warnings for a machine or material that changed after planning. Such a change can spoil a cut.
  [[nodiscard]] std::vector<Warning> changed_since(const PlanRow& plan);
  /// Cancels a plan that is being made, unless a job waits for it or a person requested the plan
  /// itself.
  void cancel_if_unwanted(const std::string& plan);
  /// Removes the plans of a design that no job uses and nobody owns. Call this in the transaction
  /// that removes the design or one of its owners. Many plans take several turns.
  void remove_unowned(const std::string& design);
  void stop() { stopped_ = true; }

  [[nodiscard]] PlanTable& table() { return plans_; }
  [[nodiscard]] std::string folder_of(const std::string& plan) const;
  /// Fetches the files of a sheet into that folder, if another node made the plan.
  ///
  /// @retval Unavailable  they are still being fetched
  [[nodiscard]] Answer<void> fetch_sheet(const std::string& plan, int sheet);

  /// Called when the planner begins a plan, and when the plan is made or has failed.
  std::function<void(const std::string&plan)> begun{}, ended{};
  /// Called now and then while a plan is made.
  std::function<void(const std::string& plan, const PlanningPhase&)> progressed{};

  struct MachineRow {
    std::string name, json;
  };
  /// The machine to plan for: that of a device, the named one, or one at `site` that suits the
  /// material.
  ///
  /// @retval Validation  there is no such device or machine, or the two do not match
  [[nodiscard]] Answer<MachineRow> machine_for(const std::string& device,
                                               const std::string& machine,
                                               const std::string& material,
                                               const std::string& site);
  /// @retval Validation  there is no such material
  [[nodiscard]] Answer<MaterialRecord> material_named(const std::string& name);

 private:
  struct Hurried {
    std::string plan, owner;
  };
  /// The plan that a request describes, with the rows of its material, machine and SVG profile. It
  /// has no id and no key, and is not stored.
  [[nodiscard]] Answer<PlanRow> rows_of(const PlanRequest& request, const Design& design,
                                        const MaterialRecord& material, const MachineRow& machine);
  [[nodiscard]] Answer<MaterialRecord> material_of(const PlanRequest& request,
                                                   const Design& design);
  [[nodiscard]] Answer<PreviewTask> make_task(const Principal& who, const std::string& way,
                                              const PlanRequest& request);
  [[nodiscard]] Answer<PreviewTask> artwork_task(const Principal& who, const std::string& id,
                                                 int sheet, const ArtworkRequest& wanted);
  /// The task of a design, with the options and tables of a plan.
  [[nodiscard]] PlanningTask task_of(const PlanRow& plan, const Design& design,
                                     PlanningTask::Kind kind);
  [[nodiscard]] Answer<PlanRow> find_or_add(const Principal& who, PlanRow row);
  [[nodiscard]] std::string next();
  [[nodiscard]] std::string next_of(const std::string& owner);
  [[nodiscard]] Begun start(const std::string& id);
  void task_ended(const std::string& id, Result<PlanningOutcome> outcome);
  void store_sheets(const std::string& id, const std::shared_ptr<PlanningOutcome>& made,
                    std::size_t from);
  [[nodiscard]] bool is_claimed_here(const PlanRow& plan) const;
  void release(const std::string& id);
  [[nodiscard]] bool remove_some_of(const std::string& design);
  void remove_more_of(const std::string& design);
  void read_on(const std::shared_ptr<PlanRecord>& record,
               const std::function<void(Answer<PlanRecord>)>& done);
  [[nodiscard]] bool is_awaited(const std::string& plan);
  /// Stores that the plan failed, unless another node makes it now. False: this cannot be stored.
  [[nodiscard]] bool fail_plan(const std::string& id, const std::string& why);
  [[nodiscard]] bool is_owned(const PlanRow& plan, const std::string& owner);
  [[nodiscard]] bool is_owned(const std::string& plan);
  /// Refuses if a job of `owner` uses the plan. If `owner` is empty, a job of anybody.
  [[nodiscard]] Answer<void> check_jobs(const std::string& plan, const std::string& owner);
  void delete_plan(const std::string& id);
  [[nodiscard]] bool is_removed(const std::string& id);

  Parts parts_;
  PlanTable plans_;
  std::map<std::string, std::uint64_t> running_;  ///< by plan: the planner's number of its task
  std::deque<Hurried> hurried_;
  std::string turn_of_{};                 ///< the owner who had the last turn
  std::set<std::string> requested_;       ///< plans that a person requested without a job
  std::set<std::string> to_release_;      ///< plans that `release` could not release yet
  std::set<std::string> partly_removed_;  ///< designs of which plans could not be removed yet
  /// By plan: what the planner made, if it could not be stored yet.
  std::map<std::string, std::shared_ptr<PlanningOutcome>> unstored_{};
  bool stopped_{false};
};

}  // namespace popcut::daemon
