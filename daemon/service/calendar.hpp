// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>

#include "daemon/service/service_store.hpp"

namespace popcut::daemon {

/// The clock by which old rows are deleted. It follows the wall clock, but not its jumps: a clock
/// that is suddenly wrong by a year must not delete a year's tokens, events and keys.
///
/// Compared with the monotonic clock, the wall clock may step ahead by up to a day (the computer
/// was asleep) or back by up to an hour. Any other step is a jump. After a jump this clock runs
/// with the monotonic one, and accepts the new time after the wall clock has kept to it for
/// `believe_ms` of run time. The database remembers this over a restart.
class Calendar {
 public:
  Calendar(ServiceStore& store, const ServiceOptions& options) : store_(store), options_(options) {}
  /// Reads the remembered state; the first time, believes the wall clock.
  void load();
  [[nodiscard]] TimeMs now();
  /// The later of this clock and the wall clock. Nothing can have happened after that.
  [[nodiscard]] TimeMs latest() { return std::max(now(), claimed_); }
  /// Stores the time now and then. Call this about once a second.
  void tick();
  /// Called in a transaction when a jump is believed: moves the expiry of idempotency keys, which
  /// are kept for seven days of run time.
  std::function<void(std::int64_t by_ms)> moved{};

 private:
  void follow();
  void store(TimeMs believed, std::int64_t held_ms);
  void believe();
  ServiceStore& store_;
  const ServiceOptions& options_;
  TimeMs believed_{};            ///< the time at `at_ms_`
  TimeMs claimed_{};             ///< the wall clock at that moment
  std::int64_t at_ms_{};         ///< monotonic
  std::int64_t held_ms_{};       ///< how long the wall clock has kept to a jump
  std::int64_t kept_at_ms_{-1};  ///< when it was stored, monotonic; -1: never
};

}  // namespace popcut::daemon
