// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "daemon/model/turns.hpp"

namespace popcut::daemon {

/// The one thread that owns the store and the service. Its queue has three lanes: work of a running
/// cut comes first (Cutting), then requests that stop a knife (Urgent), then everything else
/// (Asking).
class ServiceThread {
 public:
  enum class Lane { Cutting, Urgent, Asking };

  /// @param log  gets a line for each exception that posted work throws; from the thread
  explicit ServiceThread(std::function<void(const std::string&)> log = {});
  /// Runs what is queued, then ends.
  ~ServiceThread();
  ServiceThread(const ServiceThread&) = delete;
  ServiceThread& operator=(const ServiceThread&) = delete;

  /// Queues `work`; never blocks.
  ///
  /// @return false  the thread is ending and will not run it
  bool post(Lane lane, std::function<void()> work);
  /// Queues `work`, waits until the thread has run it, and throws what it throws. If you call this
  /// on the thread itself, `work` runs at once.
  ///
  /// @return false  the thread is ending and does not run it
  bool run(Lane lane, const std::function<void()>& work);
  /// How much work waits in all lanes.
  [[nodiscard]] std::size_t waiting() const;
  /// Runs `work` every `period_ms` in the lane Asking. If the last run has not begun yet, `work` is
  /// not queued a second time.
  void every(int period_ms, std::function<void()> work);
  void stop();
  /// How long the turns of a lane took so far. A turn is one piece of work; Urgent counts as
  /// Asking. During a turn everything else waits, even a request that stops a knife. So the time of
  /// a turn must not grow with what a client sends or with what is stored.
  [[nodiscard]] Turns turns(Lane lane) const;
  /// Forgets the measured times.
  void forget_turns();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Queues work on the service's thread for an owner. Call it from any thread. If the owner no
/// longer exists when the turn of the work comes, the work does not run.
class Poster {
 public:
  using Lane = ServiceThread::Lane;

  Poster(ServiceThread& thread, std::weak_ptr<void> owner)
      : thread_(&thread), owner_(std::move(owner)) {}
  /// As `ServiceThread::post`.
  void operator()(std::function<void()> work, Lane lane = Lane::Asking) const {
    thread_->post(lane, while_owned(std::move(work)));
  }
  /// As `ServiceThread::run`. It also returns if the work did not run.
  void run(Lane lane, std::function<void()> work) const {
    thread_->run(lane, while_owned(std::move(work)));
  }

 private:
  [[nodiscard]] std::function<void()> while_owned(std::function<void()> work) const {
    return [owner = owner_, work = std::move(work)] {
      if (const auto here = owner.lock()) work();
    };
  }
  ServiceThread* thread_;
  std::weak_ptr<void> owner_;
};

}  // namespace popcut::daemon
