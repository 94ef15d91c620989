// SPDX-License-Identifier: MIT
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "daemon/jobs/resume.hpp"
#include "daemon/service/live/program_shelf.hpp"
#include "daemon/service/repositories/job_repository.hpp"
#include "daemon/store/intent_journal.hpp"

namespace popcut::daemon {

/// The last attempt on the blank that lies in a cutter, and what is known of its strokes.
struct ResumeState {
  AttemptRow last;
  std::vector<FateRun> runs{};
  ResumeFacts facts{};
};

/// Where people's actions and the cutters meet: arms, starts, journals of running cuts and their
/// ends.
class CutDispatcher : public Cutting {
 public:
  struct Parts {
    ServiceStore& store;
    ServiceThread& thread;
    Cutters& cutters;
    JobRepository& jobs;
    PlanningQueue& plans;
    ProgramShelf& programs;
    DeviceRegistry& devices;
    IntentJournals& intents;
    const ServiceOptions& options;
    std::shared_ptr<void> alive;
  };
  explicit CutDispatcher(Parts parts) : parts_(std::move(parts)) {}
  ~CutDispatcher() override;

  Answer<Job> act(const Principal& who, const std::string& id, std::int64_t if_match,
                  const ActionRequest& request) override;
  /// What must reach the knife although nothing can be written; written when it can be.
  void stop_unrecorded(const Principal& who, const std::string& id, JobAction action) override;

  [[nodiscard]] const LiveCut* live(const std::string& job) const;
  /// Whether the sheet is still where it was registered. This knowledge ends with the
  /// session of its device, and with popcutd.
  [[nodiscard]] bool knows_place(const JobRow& row, const std::string& device) const;
  /// Complete requests that pass now, those nearest to `wanted` (or nullptr) first.
  [[nodiscard]] std::vector<NextAction> next_actions(const JobRow& row,
                                                     const ActionRequest* wanted = nullptr);
  /// Arms that have lived too long, and ends that could not be written yet.
  void tick();
  /// These devices went away: jobs that were armed for them are ready again.
  void devices_gone(const std::vector<std::string>& devices);
  /// Ends all cuts at the end of their strokes, because the store can no longer record them.
  void stop_cuts();
  void stopping() { stopping_ = true; }

  // In a fleet.

  /// Why nothing may be armed or started now; set by `FleetWatch`.
  std::function<Answer<void>()> may_cut{};
  /// Whether that attempt is cut here now, or its end is not recorded yet.
  [[nodiscard]] bool cuts(const std::string& attempt) const;
  /// The job that is cut there now; empty: none.
  [[nodiscard]] std::string job_on(const std::string& device) const;
  /// What was armed is armed no more: the node began again.
  void forget_arms();
  /// Cuts that another node called lost go on, or stop if a person decided otherwise meanwhile.
  void take_up_cuts();
  /// The answer of the database to the last change is lost: if that was a START, nobody knows yet
  /// whether it is stored.
  void doubt_start();
  /// Takes back a START of this run whose answer was lost: the knife never moved.
  ///
  /// @return false: it is none of these; its journal says what was sent
  [[nodiscard]] bool revoke_start(const AttemptRow& attempt);
  /// What others ask of a job that is cut here.
  void apply_remote_request(const std::string& job);
  [[nodiscard]] bool cutting() const { return !cuts_.empty(); }

 private:
  [[nodiscard]] std::vector<NextAction> arm_actions(const JobRow& row, const ActionRequest* wanted);
  [[nodiscard]] std::vector<NextAction> actions_when_armed(const JobRow& row);
  /// Whether what was armed is still valid.
  [[nodiscard]] bool arm_lives(const std::string& job);
  /// What is known of the blank in the cutter; nothing if it was never started.
  [[nodiscard]] std::optional<ResumeState> resume_state(const JobRow& row);
  class Journal;
  friend class Journal;
  struct Cut;

  // Each in a transaction; `row` is changed and written.
  [[nodiscard]] Answer<void> arm(const Principal& who, JobRow& row, const ActionRequest& request);
  [[nodiscard]] Answer<std::string> choose_device(const JobRow& row, const ActionRequest& request,
                                                  const PlanRow& plan) const;
  [[nodiscard]] Answer<void> start(const Principal& who, JobRow& row, const ActionRequest& request);
  [[nodiscard]] Answer<std::shared_ptr<Cut>> prepare(const JobRow& row);
  [[nodiscard]] Answer<void> pause(JobRow& row);
  [[nodiscard]] Answer<void> resume(JobRow& row);
  [[nodiscard]] Answer<void> cancel(const Principal& who, JobRow& row,
                                    const ActionRequest& request);
  [[nodiscard]] Answer<void> confirm(JobRow& row, const ActionRequest& request);
  [[nodiscard]] Answer<void> retry(JobRow& row);
  [[nodiscard]] Answer<void> resume_from(JobRow& row, const ActionRequest& request);
  [[nodiscard]] Answer<void> check_place(const JobRow& row, const std::string& device) const;
  /// Whether the cutter is at this node.
  [[nodiscard]] Answer<void> check_node(const std::string& device) const;
  [[nodiscard]] bool take_up_one(Cut& cut);
  /// Takes what the request accepts; refused while a warning that spoils a cut is left.
  [[nodiscard]] static Answer<void> accept_warnings(JobRow& row, const ActionRequest& request);
  /// The member of an `arm` that accepts the warnings of a job, with a comma; empty: none is left.
  [[nodiscard]] static std::string accepting(const JobRow& row);
  [[nodiscard]] Answer<void> check_words(const JobRow& row, const ActionRequest& request) const;
  void lapse(const std::string& job, const std::string& reason);
  void hand_over(const std::shared_ptr<Cut>& cut);
  void record_refusal(const std::shared_ptr<Cut>& cut);

  // For the journal, on the service's thread.
  [[nodiscard]] Result<void> intended(Cut& cut, std::int64_t last);
  /// Takes note of what kept a journal from being written. True: it may be tried once more.
  [[nodiscard]] bool unwritten(const StoreFault& fault);
  void progressed(Cut& cut, const SessionProgress& progress);
  void publish_progress(Cut& cut, const JobRow& row);
  void repeat_progress();
  void record_pauses();
  void ended(const std::shared_ptr<Cut>& cut, const SessionEnd& end);
  [[nodiscard]] Answer<void> record_end(Cut& cut, const SessionEnd& end);

  Parts parts_;
  std::map<std::string, std::shared_ptr<Cut>> cuts_;  ///< by job
  struct LateEnd {
    std::shared_ptr<Cut> cut;
    SessionEnd end;
  };
  std::vector<LateEnd> late_;  ///< ends that could not be written yet
  /// What was armed here, by job: nobody else changes where its cut begins.
  struct ArmedHere {
    std::int64_t until_ms{};  ///< monotonic
    int segment{};
    std::int64_t first_stroke{};
  };
  std::map<std::string, ArmedHere> armed_here_;
  /// What a person said last with resume-from, by job.
  struct AskedFrom {
    int segment{};
    std::int64_t first_stroke{};
  };
  std::map<std::string, AskedFrom> asked_from_;
  /// By job that goes on with a sheet: the session of its device in which the sheet was in place.
  std::map<std::string, std::string> placed_;
  bool stopping_{false};
  std::string starting_{};            ///< the attempt of the last START
  std::set<std::string> doubtful_{};  ///< of STARTs whose answer was lost
};

}  // namespace popcut::daemon
