// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>

#include "daemon/devices/cutters.hpp"
#include "daemon/service/live/cut_states.hpp"
#include "daemon/service/live/cut_verdict.hpp"

namespace popcut::daemon {

/// The attempts of this node from START until their end is recorded: their journals, their
/// progress, and the requests to pause or cancel them. Call it on the service's thread.
///
/// The knife moves only after the START is in the journal and in the database. Strokes are sent
/// only after their intent is recorded. If something cannot be recorded, `tick` tries again.
class RunningCuts {
 public:
  struct Parts {
    ServiceStore& store;
    Poster post;
    Cutters& cutters;
    JobRepository& jobs;
    DeviceRegistry& devices;
    IntentJournals& intents;
    const ServiceOptions& options;
  };
  explicit RunningCuts(Parts parts) : parts_(std::move(parts)) {}

  /// Stores a START, in a transaction; after its commit the cutter gets the sheet.
  ///
  /// @throws StoreFault  Constraint: the blank was started before
  void start(std::shared_ptr<Cut> cut, CutOrder order);
  /// Pauses at the end of the stroke, although nothing can be stored now. `tick` records the pause
  /// later.
  void pause_unrecorded(const std::string& job);
  /// Forgets a pause that was not recorded, because the cut was resumed.
  void forget_pause(const std::string& job);
  /// Stops `device` at the end of the stroke, and remembers that a person cancelled the cut.
  void cancel(const std::string& job, const std::string& device);
  /// Stops all cuts at the end of their stroke, because the store can no longer record them.
  void stop_all();
  /// From now on, a cut that was stopped gets the reason `shutdown`.
  void stopping() { is_stopping_ = true; }
  [[nodiscard]] bool is_stopping() const { return is_stopping_; }
  /// Publishes the last progress again, and tries again to record what could not be recorded.
  void tick();

  /// What is known of the cut of a job; nullptr if the job is not cut here.
  [[nodiscard]] const Cut* of_job(const std::string& job) const;
  /// Whether that attempt is cut here now, or its end is not recorded yet.
  [[nodiscard]] bool has(const std::string& attempt) const;
  /// Whether anything is cut here.
  [[nodiscard]] bool any() const;
  /// The job that is cut on this device; empty if there is none.
  [[nodiscard]] std::string job_on(const std::string& device) const;

  // In a fleet.

  /// Refuses while nothing may be armed or started. `FleetWatch` sets this.
  std::function<Answer<void>()> may_cut = [] { return Answer<void>(); };
  /// Makes cuts that another node called lost the current cuts of their jobs again. Stops a cut if
  /// a person has changed its job since.
  void reclaim();
  /// Revokes a START of this run that the database has stored, but whose answer was lost. The knife
  /// never moved.
  ///
  /// @return false  it is no such START; compare its journal
  [[nodiscard]] bool revoke_start(const AttemptRow& attempt);
  /// Pauses or cancels the cut if a person requested it at another node. The job's row says so.
  void apply_remote_request(const std::string& job);

 private:
  class Journal;
  friend class Journal;
  [[nodiscard]] Running* find_running(const std::string& attempt);
  [[nodiscard]] Running* find_running_of(const std::string& job);
  /// The attempts in that state.
  template <typename State>
  [[nodiscard]] std::vector<std::string> all_in() const;

  void hand_over(const std::string& attempt, CutOrder order);
  void record_refusal(const std::string& attempt);
  [[nodiscard]] Result<void> record_intent(Cut& cut, std::int64_t last_stroke);
  [[nodiscard]] bool may_write_again(const StoreFault& fault);
  void progressed(Running& running, const SessionProgress& progress);
  void record_progress(Running& running, JobRow& row);
  void publish(Running& running, const JobRow& row);
  void ended(const std::string& attempt, const SessionEnd& end);
  void try_to_record_end(const std::string& attempt);
  [[nodiscard]] Answer<void> record_end(const Ended& ended);
  void record_superseded(const Ended& ended);
  void change_job(JobRow& row, const CutVerdict& verdict, bool is_cancelled);

  Parts parts_;
  std::map<std::string, CutState> cuts_{};  ///< by attempt
  bool is_stopping_{false};
};

}  // namespace popcut::daemon
