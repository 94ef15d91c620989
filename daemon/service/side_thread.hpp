// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "daemon/service/service_thread.hpp"

namespace popcut::daemon {

/// A thread for work that takes long and needs neither the store nor the service: to read, hash and
/// remove files, or to check a copy of the database. One task after another.
class SideThread {
 public:
  /// @param log  gets a line for what cannot be removed
  explicit SideThread(ServiceThread& thread, std::function<void(const std::string&)> log = {});
  /// Waits for the task that runs, and drops the rest.
  ~SideThread();
  SideThread(const SideThread&) = delete;
  SideThread& operator=(const SideThread&) = delete;

  /// Runs `work` there, then `then` on the service's thread (lane Asking), also if `work` throws.
  /// Call this on the service's thread.
  void run(std::function<void()> work, std::function<void()> then = {});
  /// Removes a file or a folder with its content. The name is free at once. After a crash the next
  /// start removes what remains under another name (see `StateFolder::open`).
  void remove(const std::string& path);

 private:
  struct State;
  std::unique_ptr<State> state_;
  std::function<void(const std::string&)> log_;
};

}  // namespace popcut::daemon
