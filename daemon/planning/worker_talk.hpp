// SPDX-License-Identifier: MIT
#pragma once

#include <atomic>
#include <string>

#include "core/result.hpp"
#include "daemon/planning/planner.hpp"

namespace popcut::planning {

/// Cancels a task from another thread.
class CallOff {
 public:
  CallOff();
  ~CallOff();
  CallOff(const CallOff&) = delete;
  CallOff& operator=(const CallOff&) = delete;
  void call();
  [[nodiscard]] bool called() const { return called_; }
  /// Readable once it is called.
  [[nodiscard]] int descriptor() const { return event_; }

 private:
  std::atomic<bool> called_{false};
  int event_{-1};
};

/// Runs one task in a worker process of its own, from its stored files to its outcome; blocks.
///
/// @retval Refused     it was cancelled
/// @retval Infeasible  a limit was hit (which one), or the worker died
/// @retval Internal    it cannot be started, or it sent what no worker sends
/// @retval others      as `perform`
/// @param killed_by    if not null: the signal by which somebody else ended the worker (a person,
/// or
///                     the kernel for want of memory), or 0. What it died of by itself, and its
///                     limits, are not meant: they would come again.
[[nodiscard]] Result<daemon::PlanningOutcome> run_in_worker(const daemon::PlanningTask& task,
                                                            const daemon::PlanningLimits& limits,
                                                            const std::string& program,
                                                            const CallOff& call_off,
                                                            int* killed_by = nullptr);

}  // namespace popcut::planning
