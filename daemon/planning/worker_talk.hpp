// SPDX-License-Identifier: MIT
#pragma once

#include <atomic>
#include <chrono>
#include <optional>
#include <string>

#include "core/result.hpp"
#include "daemon/planning/planner.hpp"
#include "daemon/planning/worker_process.hpp"

namespace popcut::planning {

/// Cancels a task from another thread.
class CallOff {
 public:
  CallOff();
  ~CallOff();
  CallOff(const CallOff&) = delete;
  CallOff& operator=(const CallOff&) = delete;
  using Clock = std::chrono::steady_clock;
  /// The task ends `at` this time, if it has not ended by itself; the earliest one counts.
  void call(Clock::time_point at = Clock::time_point::min());
  [[nodiscard]] bool called() const { return Clock::now() >= at(); }
  /// When it ends; `Clock::time_point::max()` if it is not called off.
  [[nodiscard]] Clock::time_point at() const { return at_.load(); }
  /// Readable once it is called.
  [[nodiscard]] int descriptor() const { return event_; }

 private:
  std::atomic<Clock::time_point> at_{Clock::time_point::max()};
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

/// A worker that does one task after another (`popcutd --worker serve`), so that the next one need
/// not wait for a start. Whoever's task it did can have spoiled it: it must work for one principal
/// alone. It ends with the thread that started it.
class WarmWorker {
 public:
  /// @param limits  of one task
  WarmWorker(const daemon::PlanningLimits& limits, std::string program);

  /// As `run_in_worker`, which does tasks with a PDF. The worker is started if there is none, and
  /// replaced after 500 tasks; it is gone after a task that was cancelled, hit a limit, or ended
  /// it.
  [[nodiscard]] Result<daemon::PlanningOutcome> run(const daemon::PlanningTask& task,
                                                    const CallOff& call_off,
                                                    int* killed_by = nullptr);
  /// The last task hit the limit of its processor time.
  [[nodiscard]] bool ran_out_of_time() const { return ran_out_of_time_; }
  [[nodiscard]] bool is_running() const;
  /// How many tasks it was given since it was started.
  [[nodiscard]] int served() const { return served_; }
  void end();

 private:
  static constexpr int kMostTasks = 500;
  [[nodiscard]] Result<daemon::PlanningOutcome> run_once(const daemon::PlanningTask& task,
                                                         const CallOff& call_off, int* killed_by);
  daemon::PlanningLimits limits_;
  std::string program_;
  std::optional<WorkerProcess> process_;
  int served_{0};
  bool died_{false};  ///< in its last task, by itself
  bool ran_out_of_time_{false};
};

}  // namespace popcut::planning
