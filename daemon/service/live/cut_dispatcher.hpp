// SPDX-License-Identifier: MIT
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "daemon/jobs/resume.hpp"
#include "daemon/service/live/cut_states.hpp"
#include "daemon/service/live/program_shelf.hpp"
#include "daemon/service/live/running_cuts.hpp"

namespace popcut::daemon {

/// The last attempt on the current blank of a job, and what is known of the strokes of that blank.
struct ResumeState {
  AttemptRow last;
  std::vector<FateRun> runs{};
  ResumeFacts facts{};
};

/// Carries out what people request for the current sheet of a job: arm, start, pause, resume,
/// cancel and others. After START, `RunningCuts` takes care of the sheet.
class CutDispatcher : public Cutting {
 public:
  struct Parts {
    ServiceStore& store;
    JobRepository& jobs;
    PlanningQueue& plans;
    ProgramShelf& programs;
    DeviceRegistry& devices;
    IntentJournals& intents;
    RunningCuts& cuts;
    Cutters& cutters;
    const ServiceOptions& options;
  };
  explicit CutDispatcher(Parts parts) : parts_(parts) {}

  Answer<Job> act(const Principal& who, const std::string& id, std::int64_t if_match,
                  const ActionRequest& request) override;
  void stop_unrecorded(const Principal& who, const std::string& id, JobAction action) override;

  /// Whether the sheet is still where it was registered. After its device was away, or after a
  /// restart of popcutd, nobody knows.
  [[nodiscard]] bool knows_place(const JobRow& row, const std::string& device) const;
  /// How long START is still possible; nothing if the job was not armed by this popcutd.
  [[nodiscard]] std::optional<std::int64_t> arm_left_ms(const std::string& job) const;
  /// Complete requests that are possible now.
  ///
  /// @param wanted  the request that was refused; similar requests come first. May be nullptr
  [[nodiscard]] std::vector<NextAction> next_actions(const JobRow& stored,
                                                     const ActionRequest* wanted = nullptr);
  /// Disarms sheets whose time for START is over.
  void tick();
  /// Disarms the sheets that were armed in these devices.
  void devices_gone(const std::vector<std::string>& devices);
  /// Forgets that the sheet of a job was armed here.
  void forget_arm(const std::string& job);
  /// Forgets all arms. In a fleet, when the node begins again, nothing is armed in the database.
  void forget_arms();

 private:
  [[nodiscard]] std::vector<NextAction> arm_actions(const JobRow& row, const ActionRequest* wanted);
  [[nodiscard]] std::vector<NextAction> actions_when_armed(const JobRow& row);
  /// What was armed here, if START may still follow; nullptr if the arm has expired or was deleted.
  [[nodiscard]] const Armed* valid_arm(const std::string& job);
  /// What is known of the current blank; nothing if it was never started.
  [[nodiscard]] std::optional<ResumeState> resume_state(const JobRow& row);

  // Each of these changes and stores `row`, in a transaction.
  [[nodiscard]] Answer<Job> act_on(const Principal& who, JobRow& row, const ActionRequest& request);
  [[nodiscard]] Answer<void> change(const Principal& who, JobRow& row,
                                    const ActionRequest& request);
  [[nodiscard]] Answer<void> arm(const Principal& who, JobRow& row, const ActionRequest& request);
  [[nodiscard]] Answer<std::string> choose_device(const JobRow& row, const ActionRequest& request,
                                                  const PlanRow& plan) const;
  [[nodiscard]] Answer<void> disarm(JobRow& row);
  [[nodiscard]] Answer<void> start(const Principal& who, JobRow& row);
  [[nodiscard]] Answer<void> pause(JobRow& row);
  [[nodiscard]] Answer<void> resume(JobRow& row);
  [[nodiscard]] Answer<void> cancel(const Principal& who, JobRow& row,
                                    const ActionRequest& request);
  [[nodiscard]] Answer<void> confirm(JobRow& row, const ActionRequest& request);
  [[nodiscard]] Answer<void> retry(JobRow& row);
  [[nodiscard]] Answer<void> resume_from(JobRow& row, const ActionRequest& request);

  // Each of these returns a problem, or does nothing.
  [[nodiscard]] Answer<void> check_armed(const JobRow& row, const std::optional<PlanRow>& plan);
  [[nodiscard]] Answer<void> check_device(const JobRow& row, const PlanRow& plan) const;
  [[nodiscard]] Answer<void> check_place(const JobRow& row, const std::string& device) const;
  /// Refuses if the cutter is at another node.
  [[nodiscard]] Answer<void> check_node(const std::string& device) const;
  [[nodiscard]] Answer<void> check_members(const JobRow& row, const ActionRequest& request) const;

  /// The sheet to cut next, and its program.
  struct ReadySheet {
    SheetPlan plan;
    EncodedProgram program;
  };
  [[nodiscard]] Answer<ReadySheet> ready_sheet(const JobRow& row);
  /// Removes from `row` the warnings that the request accepts. Refuses if it does not accept all
  /// warnings about what may spoil the sheet.
  [[nodiscard]] static Answer<void> accept_warnings(JobRow& row, const ActionRequest& request);
  /// The request to arm a job, with all its warnings accepted.
  [[nodiscard]] static NextAction arm_action(const JobRow& row, const std::string& device);
  /// Disarms a job although nobody requested it. If this cannot be stored, `tick` tries again.
  void disarm_because(const std::string& job, const std::string& reason);
  /// The job whose sheet the present request registers, and the session of its device. `next_` gets
  /// this only after the commit, but the answer to the request already needs it.
  struct Placing {
    std::string job, session;
  };
  std::optional<Placing> placing_{};

  Parts parts_;
  std::map<std::string, NextCut> next_{};  ///< by job
};

}  // namespace popcut::daemon
