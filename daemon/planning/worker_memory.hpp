// SPDX-License-Identifier: MIT
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <string>

namespace popcut::planning {

/// The memory that all workers may have together. When they have more, one must end: of the
/// principal whose workers have most, the one that has most. For several threads at once.
class WorkerMemory {
 public:
  /// @param bytes  of all workers
  /// @param group  a descriptor of `cgroup.procs` of a control group for workers, which this object
  ///               closes; -1: there is none
  explicit WorkerMemory(std::uint64_t bytes, int group = -1) : most_(bytes), group_(group) {}
  ~WorkerMemory();
  WorkerMemory(const WorkerMemory&) = delete;
  WorkerMemory& operator=(const WorkerMemory&) = delete;

  [[nodiscard]] std::uint64_t bytes() const { return most_; }
  [[nodiscard]] int group() const { return group_; }

  /// A worker that runs, for as long as this lives.
  class Place {
   public:
    /// @param memory  null: nothing is measured
    Place(std::shared_ptr<WorkerMemory> memory, pid_t pid, std::string who);
    ~Place();
    Place(const Place&) = delete;
    Place& operator=(const Place&) = delete;
    /// Measures all workers now and then; true if this one must end. Ask often while it runs.
    [[nodiscard]] bool must_end();

   private:
    friend class WorkerMemory;
    std::shared_ptr<WorkerMemory> memory_;
    pid_t pid_;
    std::string who_;
    std::uint64_t bytes_{0};
    bool must_end_{false};
  };

 private:
  void measure();
  const std::uint64_t most_;
  const int group_;
  std::mutex mutex_;
  std::list<Place*> places_;
  std::chrono::steady_clock::time_point measured_{};
};

}  // namespace popcut::planning
