// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "daemon/jobs/rules.hpp"
#include "daemon/service/principal_titles.hpp"
#include "daemon/service/repositories/planning_queue.hpp"
#include "daemon/service/service.hpp"
#include "daemon/store/attempt_table.hpp"
#include "daemon/store/job_table.hpp"

namespace popcut::daemon {

/// What is known of a sheet while it is cut, and not stored.
struct LiveCut {
  std::int64_t certain{}, sent{};  ///< strokes of this blank
  std::int64_t done{};             ///< strokes that are probably cut
  double cut_share{};              ///< part of the sheet's strokes that is estimated to be done
  double seconds_left{-1};         ///< of the sheet; below 0: not known yet
};

/// The rows of jobs, and the requests that change them. Requests at a cutter are in
/// `CutDispatcher`.
class JobRepository : public Jobs {
 public:
  struct Parts {
    ServiceStore& store;
    Poster post;
    PlanningQueue& plans;
    DeviceRegistry& devices;
    PrincipalTitles& titles;
    const ServiceOptions& options;
  };
  explicit JobRepository(Parts parts)
      : parts_(std::move(parts)),
        jobs_(parts_.store.db()),
        attempts_(parts_.store.db(), parts_.store.node()) {}

  Answer<Job> create(const Principal& who, const JobCreate& request) override;
  /// Creates a job that cuts the test shape of a material; empty: of the default material.
  [[nodiscard]] Answer<Job> create_test(const Principal& who, const std::string& device,
                                        const std::string& material);
  Answer<Page<Job>> list(const JobFilter& filter, const PageRequest& request) override;
  Answer<Job> find(const std::string& id) override;
  Answer<Job> brief(const std::string& id) override;
  Answer<std::vector<SheetRecord>> sheets(const std::string& id, int first, int most) override;
  Answer<Ledger> ledger(const std::string& id, int sheet) override;
  Answer<Job> patch(const Principal& who, const std::string& id, std::int64_t if_match,
                    const JobPatch& request) override;
  /// The request that plans a job again for a device; nothing if that is not needed or possible.
  [[nodiscard]] std::optional<NextAction> plan_again_action(const JobRow& row,
                                                            const std::string& device,
                                                            const PlanRow& plan);
  /// The request that changes the device of a job, and its site if the device is elsewhere.
  [[nodiscard]] NextAction change_action(const JobRow& row, const std::string& device,
                                         bool plan_again = false) const;
  Answer<void> remove(const Principal& who, const std::string& id) override;
  Answer<Page<Job>> queue(const std::string& device, const PageRequest& request) override;
  Answer<Job> hold(const Principal& who, const std::string& id, bool held) override;
  Answer<Job> move(const Principal& who, const std::string& id, const std::string& before) override;

  /// Sets jobs of a plan to "planning". At most 200 of them, so that the turn is short.
  void plan_begun(const std::string& plan);
  /// Publishes the progress of a plan for each of its jobs; nothing is stored.
  void plan_progressed(const std::string& plan, const PlanningPhase& phase);
  /// Updates all jobs of a plan that is made or has failed. Many jobs take several turns.
  void plan_ended(const std::string& plan);
  /// Calls `plan_ended` for each plan that is made or has failed and still has queued jobs, because
  /// popcutd ended in between.
  void plans_ended_before();
  /// Repeats the updates of `plan_ended` that could not be stored.
  void catch_up();

  // For classes that change jobs, in a transaction.
  [[nodiscard]] JobTable& table() { return jobs_; }
  [[nodiscard]] AttemptTable& attempts() { return attempts_; }
  [[nodiscard]] Answer<JobRow> row(const std::string& id);
  /// Changes the state of the job by a step. Stores the row, the row of the sheet and an event.
  void apply(JobRow& row, Step step, const std::string& reason);
  /// Like `apply`. But if a person in a fleet asked to cancel a job that would be interrupted or
  /// ready, the job becomes cancelled.
  void apply_or_cancel(JobRow& row, Step step, const std::string& reason);
  /// Deletes the arm of a job. Call `apply` for its row, too.
  void disarm(const std::string& job);
  /// Stores the row and an event, without a step.
  void save(JobRow& row);
  /// Ends the current sheet ("done" or "skipped"). Then the job is ready for the next sheet, or
  /// done.
  void finish_sheet(JobRow& row, const std::string& sheet_state, const std::string& reason);
  void set_attention(JobRow& row, const std::string& kind, const std::string& text) const;
  /// Sets the counts of `row`: the strokes of a blank that are certainly cut, and those that may
  /// be.
  void count_paths(JobRow& row, int sheet, int blank, std::int64_t strokes);

  [[nodiscard]] static JobFacts facts_of(const JobRow& row);
  /// The job as the API shows it.
  [[nodiscard]] Job shown(const JobRow& row) const;
  /// 409 with the state and the allowed actions.
  [[nodiscard]] static Problem conflict(const JobRow& row, std::string detail);
  [[nodiscard]] static tl::unexpected<Problem> refuse_state(const JobRow& row, std::string detail) {
    return tl::unexpected(conflict(row, std::move(detail)));
  }
  /// 412 unless `if_match` is the job's revision.
  [[nodiscard]] static Answer<void> check_rev(const JobRow& row, std::int64_t if_match);

  /// The number of the plan's sheet that sheet `k` of the job repeats: each copy has all sheets of
  /// the plan.
  [[nodiscard]] static int plan_sheet(const JobRow& row, int k, int plan_sheets) {
    return row.sheets_total == 0 || plan_sheets == 0 ? 0 : (k - 1) % plan_sheets + 1;
  }
  [[nodiscard]] std::optional<SheetPlan> current_sheet(const JobRow& row);
  /// Warnings about the device that popcutd chose for a job without one.
  [[nodiscard]] std::vector<Warning> choice_warnings(const std::string& material,
                                                     const std::string& site) const;
  /// New warnings about changed tables. Empty unless the job is ready. Accepted warnings are left
  /// out.
  [[nodiscard]] std::vector<Warning> changed_since_planned(const JobRow& row) const;
  /// Whether the job can get another plan: nothing of it was cut.
  [[nodiscard]] bool may_plan_again(const JobRow& row);
  [[nodiscard]] Answer<void> plan_again(const Principal& who, JobRow& row, const JobPatch& request);
  /// `JobRow::load` of the current sheet.
  [[nodiscard]] std::optional<LoadedSheet> load_of(const JobRow& row);

  /// What a running cut knows; nullptr if the job is not cut here.
  std::function<const LiveCut*(const std::string& job)> live{};
  /// Complete requests that are possible now.
  std::function<std::vector<NextAction>(const JobRow&)> next_actions{};
  /// The same, but each with the id of the job. Use this in a problem that may be about another
  /// job.
  [[nodiscard]] std::vector<NextAction> next_actions_of(const JobRow& row) const;
  /// Called after the commit of `disarm`.
  std::function<void(const std::string& job)> disarmed{};
  /// How long START is still possible; nothing if the job was not armed at this node.
  std::function<std::optional<std::int64_t>(const std::string& job)> arm_left_ms{};
  /// Whether the sheet with which a job continues is still where it was registered.
  std::function<bool(const JobRow&)> knows_place{};

 private:
  /// The problem, with complete requests that are possible now.
  [[nodiscard]] tl::unexpected<Problem> refused(const JobRow& row, Problem problem) const;
  /// The devices that a job could change to.
  [[nodiscard]] std::vector<NextAction> other_devices(const JobRow& row) const;
  [[nodiscard]] bool lost_its_place(const JobRow& row) const;
  [[nodiscard]] std::vector<Warning> warnings_of(const JobRow& row) const;
  [[nodiscard]] std::vector<std::string> actions_of(const JobRow& row) const;
  [[nodiscard]] Answer<Job> add(const Principal& who, const JobCreate& request,
                                const PlanRow& plan);
  [[nodiscard]] Answer<void> check(const JobCreate& request) const;
  [[nodiscard]] Answer<void> check_site(const JobRow& row, const JobPatch& request) const;
  void apply_plan(JobRow& row, const PlanRow& plan);
  std::set<std::string> left_over_{};  ///< plans whose jobs could not be updated
  void end_job(JobRow& row) const;
  void put_sheet(const JobRow& row, std::string_view state, std::optional<TimeMs> finished = {});
  [[nodiscard]] std::optional<Attention> attention_of(const JobRow& row) const;
  [[nodiscard]] std::optional<TimeMs> armed_until(const JobRow& row) const;
  Parts parts_;
  JobTable jobs_;
  AttemptTable attempts_;
};

}  // namespace popcut::daemon
