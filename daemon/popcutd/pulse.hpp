// SPDX-License-Identifier: MIT
#pragma once

#include <atomic>
#include <chrono>
#include <exception>
#include <mutex>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "daemon/service/service.hpp"
#include "daemon/service/service_thread.hpp"

namespace popcut::daemon {

/// Whether the service's thread takes turns, for the watchdog, and what it says of itself.
class Pulse {
 public:
  /// Puts a beat on the service's thread, unless one waits there already.
  void ask(ServiceThread& thread, Service& service) {
    if (asked_.exchange(true)) return;
    bool taken = false;
    try {
      taken = thread.post(ServiceThread::Lane::Asking, [this, &service] { beat(service); });
    } catch (const std::exception&) {  // no memory; the next one is asked for soon
    }
    if (!taken) asked_ = false;
  }
  [[nodiscard]] bool alive(double stuck_s) const {
    const std::lock_guard hold(lock_);
    return std::chrono::duration<double>(Clock::now() - beat_).count() < stuck_s;
  }
  [[nodiscard]] std::string status() const {
    const std::lock_guard hold(lock_);
    return status_;
  }

 private:
  using Clock = std::chrono::steady_clock;

  void beat(Service& service) {
    std::string status;
    try {
      for (const DeviceRecord& device : service.devices.list())
        if (device.state == "busy")
          status += fmt::format("{}{} is cutting job {}", status.empty() ? "" : "; ", device.id,
                                device.job);
      if (status.empty()) status = "waiting for jobs";
    } catch (const std::exception&) {  // the thread takes its turns, whatever cannot be read
      status.clear();
    }
    const std::lock_guard hold(lock_);
    if (!status.empty()) status_ = std::move(status);
    beat_ = Clock::now();
    asked_ = false;
  }

  mutable std::mutex lock_;
  std::atomic<bool> asked_{false};
  Clock::time_point beat_{Clock::now()};
  std::string status_;
};

}  // namespace popcut::daemon
