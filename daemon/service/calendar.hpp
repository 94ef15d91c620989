// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>

#include "daemon/service/service_store.hpp"

namespace popcut::daemon {

/// The clock by which old rows are deleted. It follows the wall clock, but not its jumps. Otherwise
/// a wall clock that is suddenly wrong by a year would delete a year's tokens, events and keys.
///
/// A step is the difference between what the wall clock and the monotonic clock measured. A step is
/// normal up to a day ahead (the computer was asleep) and up to an hour back. Any other step is a
/// jump. After a jump this clock runs with the monotonic one. It accepts the time of the wall clock
/// after popcutd has run for `believe_ms` without another jump. The database keeps this over a
/// restart.
class Calendar {
 public:
  Calendar(ServiceStore& store, const ServiceOptions& options) : store_(store), options_(options) {}
  /// Reads the stored state. Without one, takes the time of the wall clock.
  void load();
  [[nodiscard]] TimeMs now();
  /// The later of this clock and the wall clock. A time after that is wrong.
  [[nodiscard]] TimeMs latest() { return std::max(now(), claimed_); }
  /// Accepts a jump when it is time to, and stores the state every ten minutes. Call this about
  /// once a second.
  void tick();
  /// Called in the transaction that accepts a jump. It moves the expiry of idempotency keys,
  /// because they are kept for seven days of run time.
  std::function<void(std::int64_t by_ms)> moved{};

 private:
  void follow();
  void store(TimeMs believed, std::int64_t held_ms);
  void believe();
  ServiceStore& store_;
  const ServiceOptions& options_;
  TimeMs believed_{};            ///< what this clock showed at `at_ms_`
  TimeMs claimed_{};             ///< what the wall clock showed at `at_ms_`
  std::int64_t at_ms_{};         ///< monotonic
  std::int64_t held_ms_{};       ///< run time since the last jump
  std::int64_t kept_at_ms_{-1};  ///< when the state was stored, monotonic; -1: never
};

}  // namespace popcut::daemon
