// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "daemon/service/service_thread.hpp"

namespace popcut::daemon {

/// A thread for work that takes long and uses neither the store nor the service. It reads, hashes
/// and removes files, and checks copies of the database. It runs one task after another.
class SideThread {
 public:
  /// @param log  gets a line for what cannot be removed
  explicit SideThread(ServiceThread& thread, std::function<void(const std::string&)> log = {});
  /// Waits for the task that runs, and drops the rest.
  ~SideThread();
  SideThread(const SideThread&) = delete;
  SideThread& operator=(const SideThread&) = delete;

  /// Queues `work` for this thread. After `work`, even if it throws, `then` runs on the service's
  /// thread (lane Asking). Call this on the service's thread.
  void run(std::function<void()> work, std::function<void()> then = {});
  /// Renames a file or a folder at once, so that its path is free, and removes it on this thread.
  /// What a crash leaves is removed at the next start (see `StateFolder::open`).
  void remove(const std::string& path);

 private:
  struct State;
  std::unique_ptr<State> state_;
  std::function<void(const std::string&)> log_;
};

}  // namespace popcut::daemon
