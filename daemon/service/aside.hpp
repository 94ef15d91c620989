// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "daemon/service/service_thread.hpp"

namespace popcut::daemon {

/// A thread for what takes long and needs neither the store nor the service: reading, hashing and
/// removing files, checking a copy of the database. One thing after another.
class Aside {
 public:
  explicit Aside(ServiceThread& thread);
  /// Ends what runs, and drops the rest.
  ~Aside();
  Aside(const Aside&) = delete;
  Aside& operator=(const Aside&) = delete;

  /// Runs `work` there, then `then` on the service's thread (lane Asking). What `work` throws is
  /// dropped, and `then` runs all the same. From the service's thread.
  void run(std::function<void()> work, std::function<void()> then = {});
  /// Removes a file or a folder with all that is in it. Its name is free at once; what remains
  /// below another name after a crash, the next start removes (see `StateFolder::open`).
  void remove(const std::string& path);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace popcut::daemon
