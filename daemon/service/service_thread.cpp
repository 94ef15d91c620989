// SPDX-License-Identifier: MIT
#include "daemon/service/service_thread.hpp"

#include <chrono>
#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <new>
#include <thread>
#include <utility>

#include <fmt/format.h>

namespace popcut::daemon {

using Clock = std::chrono::steady_clock;

struct ServiceThread::State {
  struct Periodic {
    Clock::time_point next;
    std::chrono::milliseconds period;
    std::function<void()> work;
    bool is_queued{false};
  };

  mutable std::mutex mutex;
  std::condition_variable wake;
  std::deque<std::function<void()>> cutting, urgent, asking;
  std::deque<Periodic> periodic;  // a deque, because queued work refers to its elements
  std::function<void(const std::string&)> log;
  Turns of_cutting, of_asking;
  bool ending{false};
  std::thread thread;

  // Queues the periodic work that is due. Returns the time at which to call it again.
  Clock::time_point queue_due() {
    const Clock::time_point now = Clock::now();
    Clock::time_point next = now + std::chrono::hours(1);
    for (Periodic& one : periodic) {
      if (one.next <= now && !ending) {
        one.next = now + one.period;
        if (!one.is_queued) try_to([&] { queue(one); });
      }
      next = std::min(next, one.next);
    }
    return next;
  }

  void queue(Periodic& one) {
    asking.emplace_back([this, &one] {
      {
        const std::lock_guard lock(mutex);
        one.is_queued = false;
      }
      one.work();
    });
    one.is_queued = true;
  }

  // Logs what `work` throws, because cuts must continue. Work that somebody waits for throws
  // nothing here: `run` passes its exception to the caller.
  template <typename Work>
  void try_to(const Work& work) const {
    try {
      work();
    } catch (const std::exception& fault) {
      try {
        if (log) log(fmt::format("work of the service failed: {}", fault.what()));
      } catch (...) {  // not even memory to say so
      }
    } catch (...) {
      try {
        if (log) log("work of the service failed");
      } catch (...) {
      }
    }
  }

  // Locks `lock`, which guards `turns`.
  static void lock_and_add(Turns& turns, const TurnClock& clock,
                           std::unique_lock<std::mutex>& lock) {
    const TurnTime time = clock.elapsed();
    lock.lock();
    try {
      turns.add(TurnClock::name(), time);
    } catch (const std::bad_alloc&) {  // then one figure is lost
    }
  }

  void loop() {
    std::unique_lock lock(mutex);
    for (;;) {
      const Clock::time_point next = queue_due();
      const bool is_asking = cutting.empty();
      std::deque<std::function<void()>>& lane = !is_asking        ? cutting
                                                : !urgent.empty() ? urgent
                                                                  : asking;
      if (lane.empty()) {
        if (ending) return;
        wake.wait_until(lock, next);
        continue;
      }
      std::function<void()> work = std::move(lane.front());
      lane.pop_front();
      lock.unlock();
      const TurnClock clock;
      try_to(work);
      work = {};  // destroys what it holds in this turn, too
      lock_and_add(is_asking ? of_asking : of_cutting, clock, lock);
    }
  }
};

ServiceThread::ServiceThread(std::function<void(const std::string&)> log)
    : state_(std::make_unique<State>()) {
  state_->log = std::move(log);
  state_->thread = std::thread([this] { state_->loop(); });
}

ServiceThread::~ServiceThread() { stop(); }

bool ServiceThread::post(Lane lane, std::function<void()> work) {
  {
    const std::lock_guard lock(state_->mutex);
    if (state_->ending) return false;
    (lane == Lane::Cutting  ? state_->cutting
     : lane == Lane::Urgent ? state_->urgent
                            : state_->asking)
        .push_back(std::move(work));
  }
  state_->wake.notify_one();
  return true;
}

bool ServiceThread::run(Lane lane, const std::function<void()>& work) {
  if (std::this_thread::get_id() == state_->thread.get_id()) {
    work();
    return true;
  }
  std::mutex mutex;
  std::condition_variable over;
  bool done = false;
  std::exception_ptr fault;
  const bool queued = post(lane, [&] {
    try {
      work();
    } catch (...) {
      fault = std::current_exception();
    }
    // Notify under the lock, because the waiting thread destroys both as soon as it has the lock.
    const std::lock_guard lock(mutex);
    done = true;
    over.notify_one();
  });
  if (!queued) return false;
  std::unique_lock lock(mutex);
  over.wait(lock, [&] { return done; });
  if (fault) std::rethrow_exception(fault);
  return true;
}

std::size_t ServiceThread::waiting() const {
  const std::lock_guard lock(state_->mutex);
  return state_->cutting.size() + state_->urgent.size() + state_->asking.size();
}

Turns ServiceThread::turns(Lane lane) const {
  const std::lock_guard lock(state_->mutex);
  return lane == Lane::Cutting ? state_->of_cutting : state_->of_asking;
}

void ServiceThread::forget_turns() {
  const std::lock_guard lock(state_->mutex);
  state_->of_cutting = state_->of_asking = {};
}

void ServiceThread::every(int period_ms, std::function<void()> work) {
  const std::chrono::milliseconds period(period_ms);
  {
    const std::lock_guard lock(state_->mutex);
    state_->periodic.push_back({Clock::now() + period, period, std::move(work)});
  }
  state_->wake.notify_one();
}

void ServiceThread::stop() {
  {
    const std::lock_guard lock(state_->mutex);
    state_->ending = true;
  }
  state_->wake.notify_one();
  if (state_->thread.joinable() && std::this_thread::get_id() != state_->thread.get_id())
    state_->thread.join();
}

}  // namespace popcut::daemon
