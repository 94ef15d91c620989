// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>

#include "daemon/service/service_store.hpp"

namespace popcut::daemon {

/// The time by which old things are forgotten. It follows the wall's clock, but not its jumps: a
/// clock that is suddenly wrong by a year must not delete a year's worth of tokens, events and
/// keys.
///
/// Against the monotonic clock the wall's may go ahead by up to a day (the computer was asleep) or
/// back by up to an hour. Anything else is a jump: this clock then goes on at the pace of the
/// monotonic one, and takes the new time over once the wall has held to it for `believe_ms` of run
/// time. Over a restart it is remembered in the database.
class Calendar {
 public:
  Calendar(ServiceStore& store, const ServiceOptions& options) : store_(store), options_(options) {}
  /// Reads what was remembered; the first time, the wall's clock is believed.
  void load();
  [[nodiscard]] TimeMs now();
  /// The later of this clock and the wall's: nothing that happened is from after it.
  [[nodiscard]] TimeMs latest() { return std::max(now(), claimed_); }
  /// Remembers the time now and then. To be called about once a second.
  void tick();
  /// What the keys of requests are moved by when a jump is believed, in its transaction: they are
  /// kept for seven days of run time.
  std::function<void(std::int64_t by_ms)> moved{};

 private:
  void follow();
  void keep();
  void believe();
  ServiceStore& store_;
  const ServiceOptions& options_;
  TimeMs believed_{};            ///< the time at `at_ms_`
  TimeMs claimed_{};             ///< what the wall said then
  std::int64_t at_ms_{};         ///< monotonic
  std::int64_t held_ms_{};       ///< how long the wall has held to what is not believed
  std::int64_t kept_at_ms_{-1};  ///< monotonic; -1: never
};

}  // namespace popcut::daemon
