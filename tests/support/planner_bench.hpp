// SPDX-License-Identifier: MIT
#pragma once

#include <dirent.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <fstream>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "daemon/planning/planner.hpp"
#include "tests/support/process.hpp"
#include "tests/support/timing.hpp"

namespace popcut::testing {

using daemon::PlanningFile;
using daemon::PlanningLimits;
using daemon::PlanningOutcome;
using daemon::PlanningTask;

/// Collects the planner's answers; waits for them as long as a test may.
class Outcomes {
 public:
  daemon::Planner::Done slot(const std::string& name) {
    return [this, name](Result<PlanningOutcome> outcome) {
      const std::lock_guard lock(mutex_);
      CHECK(answers_.emplace(name, std::move(outcome)).second);  // once
      order_.push_back(name);
      came_.notify_all();
    };
  }
  Result<PlanningOutcome> wait(const std::string& name) {
    std::unique_lock lock(mutex_);
    const bool here =
        came_.wait_for(lock, std::chrono::seconds(900), [&] { return answers_.contains(name); });
    REQUIRE(here);
    return answers_.at(name);
  }
  std::vector<std::string> order() {
    const std::lock_guard lock(mutex_);
    return order_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable came_;
  std::map<std::string, Result<PlanningOutcome>> answers_;
  std::vector<std::string> order_;
};

/// Child processes of this one, including zombies.
inline std::vector<int> children() {
  std::vector<int> pids;
  if (DIR* folder = ::opendir("/proc/self/task")) {
    while (const dirent* entry = ::readdir(folder)) {
      std::ifstream list("/proc/self/task/" + std::string(entry->d_name) + "/children");
      for (int pid = 0; list >> pid;) pids.push_back(pid);
    }
    ::closedir(folder);
  }
  return pids;
}

inline std::size_t open_descriptors() {
  std::size_t count = 0;
  if (DIR* folder = ::opendir("/proc/self/fd")) {
    while (::readdir(folder) != nullptr) ++count;
    ::closedir(folder);
  }
  return count;
}

inline const PlanningFile* file_of(const PlanningOutcome& outcome, const std::string& name) {
  for (const PlanningFile& file : outcome.files)
    if (file.name == name) return &file;
  return nullptr;
}

inline std::string why(const Result<PlanningOutcome>& outcome) {
  return outcome ? std::string() : message(outcome.error());
}

}  // namespace popcut::testing
