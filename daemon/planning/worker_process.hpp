// SPDX-License-Identifier: MIT
#pragma once

#include <sys/types.h>

#include <string>

#include "core/result.hpp"
#include "daemon/planning/planner.hpp"

namespace popcut::planning {

/// A child that runs this program as `--worker`: nothing of ours is open in it but three pipes, its
/// environment is empty, it works within its limits and dies with the thread that started it. Where
/// the kernel lets, it sees no other process: it is the first one in a namespace of its own.
class WorkerProcess {
 public:
  /// @retval Internal  it cannot be started (no descriptors, no processes left)
  /// @param word  after `--worker`; null: none
  [[nodiscard]] static Result<WorkerProcess> start(const std::string& program,
                                                   const daemon::PlanningLimits& limits,
                                                   const char* word = nullptr);
  WorkerProcess(WorkerProcess&& other) noexcept;
  WorkerProcess& operator=(WorkerProcess&&) = delete;
  WorkerProcess(const WorkerProcess&) = delete;
  WorkerProcess& operator=(const WorkerProcess&) = delete;
  ~WorkerProcess();  ///< kills it and waits for it

  /// The pipes, without blocking; -1 once closed.
  [[nodiscard]] int to() const { return to_; }
  [[nodiscard]] int from() const { return from_; }
  [[nodiscard]] int errors() const { return errors_; }
  [[nodiscard]] pid_t pid() const { return pid_; }
  void close_to();
  void close_errors();
  void kill() { ended_by_us_ = true, send_kill(); }
  /// It was killed from here, not by somebody else.
  [[nodiscard]] bool is_ended_by_us() const { return ended_by_us_; }
  /// Its status as `waitpid` has it. It is killed if it does not end within a second or two.
  int wait();
  /// It was waited for.
  [[nodiscard]] bool has_ended() const { return pid_ < 0; }
  /// Processor time that it took, once it was waited for.
  [[nodiscard]] double cpu_s() const { return cpu_s_; }
  /// Processor time that it has taken so far; 0 if the kernel does not say.
  [[nodiscard]] double cpu_so_far_s() const;
  /// Why it has no namespaces of its own, as errno has it; 0: it has.
  [[nodiscard]] int namespaces_error() const { return namespaces_error_; }

 private:
  WorkerProcess() = default;
  void send_kill() const;
  bool ended_by_us_{false};
  int to_{-1}, from_{-1}, errors_{-1};
  pid_t pid_{-1};
  int namespaces_error_{0};
  double cpu_s_{0};
};

}  // namespace popcut::planning
