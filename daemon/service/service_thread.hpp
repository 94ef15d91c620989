// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <functional>
#include <memory>

#include "daemon/model/turns.hpp"

namespace popcut::daemon {

/// The one thread that owns the store and the service. It has three lanes: work of a running cut
/// comes before requests that stop a knife, and those before all others.
class ServiceThread {
 public:
  enum class Lane { Cutting, Urgent, Asking };

  ServiceThread();
  /// Runs what is queued, then ends.
  ~ServiceThread();
  ServiceThread(const ServiceThread&) = delete;
  ServiceThread& operator=(const ServiceThread&) = delete;

  /// Queues `work`; never blocks. False: the thread is ending and will not run it.
  bool post(Lane lane, std::function<void()> work);
  /// Runs `work` there and waits for it; what it throws is thrown here. From the thread itself it
  /// runs at once. (What is thrown by posted work is dropped.)
  bool run(Lane lane, const std::function<void()>& work);
  /// How many wait, of all lanes.
  [[nodiscard]] std::size_t waiting() const;
  /// Runs `work` every `period_ms` in the lane Asking.
  void every(int period_ms, std::function<void()> work);
  void stop();
  /// What each lane's turns came to so far (Urgent is part of Asking). A turn holds up all that
  /// wait, also those who stop a knife: none may take time in proportion to what a client sends or
  /// to what is stored.
  [[nodiscard]] Turns turns(Lane lane) const;
  /// Forgets what it measured so far.
  void forget_turns();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace popcut::daemon
