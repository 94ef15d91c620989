// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "daemon/model/model.hpp"
#include "daemon/model/problem.hpp"

namespace popcut::daemon {

/// The jobs and their queue. See `Service`.
class Jobs {
 public:
  virtual ~Jobs() = default;
  [[nodiscard]] virtual Answer<Job> create(const Principal&, const JobCreate&) = 0;
  [[nodiscard]] virtual Answer<Page<Job>> list(const JobFilter&, const PageRequest&) = 0;
  [[nodiscard]] virtual Answer<Job> find(const std::string& id) = 0;
  [[nodiscard]] virtual Answer<std::vector<SheetRecord>> sheets(const std::string& job) = 0;
  [[nodiscard]] virtual Answer<Ledger> ledger(const std::string& job, int sheet) = 0;
  [[nodiscard]] virtual Answer<Job> patch(const Principal&, const std::string& id,
                                          std::int64_t if_match, const JobPatch&) = 0;
  [[nodiscard]] virtual Answer<void> remove(const Principal&, const std::string& id) = 0;

  /// Jobs that have not ended, in the order in which each device will be offered them. A page may
  /// have fewer than its limit and yet another after it.
  [[nodiscard]] virtual Answer<Page<Job>> queue(const std::string& device, const PageRequest&) = 0;
  [[nodiscard]] virtual Answer<Job> hold(const Principal&, const std::string& job, bool held) = 0;
  /// Puts `job` before `before` (empty: to the end) among those of its priority.
  [[nodiscard]] virtual Answer<Job> move(const Principal&, const std::string& job,
                                         const std::string& before) = 0;
};

/// What people do with a job's current sheet: arm, start, pause, cancel, ... See `Service`.
class Cutting {
 public:
  virtual ~Cutting() = default;
  [[nodiscard]] virtual Answer<Job> act(const Principal&, const std::string& id,
                                        std::int64_t if_match, const ActionRequest&) = 0;
};

}  // namespace popcut::daemon
